"""The face: the commands, their progress, their answers and their exit status."""
