"""The chapters of the report, from the results of the work."""
