"""The figures of the report and of a comparison."""
