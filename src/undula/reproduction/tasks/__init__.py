"""The commands that the statements rest on, as tasks."""
