"""The pieces of work: functions of plain arguments that return dictionaries for JSON, the same for the same seed."""
