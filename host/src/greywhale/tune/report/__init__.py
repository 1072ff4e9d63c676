"""A tuning's results for people: controller.toml, a summary, the paper's tables, pictures."""
