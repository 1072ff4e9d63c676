"""What people get from a tuning: controller.toml, a summary, the paper's tables, pictures."""
