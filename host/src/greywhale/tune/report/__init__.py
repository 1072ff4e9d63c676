"""What people get of a tuning: controller.toml, a summary, the paper's tables, pictures."""
