"""Names and numbers of the formats of stored results."""

#: Format of a stored run.
RUN_FORMAT = "run 1"
#: Format of a stored record.
RECORD_FORMAT = "record 1"
