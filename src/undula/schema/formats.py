"""Names and numbers of the formats of stored results."""

#: Format of a stored run.
RUN_FORMAT = "run 1"
