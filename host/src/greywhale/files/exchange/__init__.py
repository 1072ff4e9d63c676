"""Logs in the formats of other programs: a module for each format, and one table of them (`formats`)."""
