"""Every picture: how things look, legends, marks, files, and the drawing of logs, models and controllers."""
