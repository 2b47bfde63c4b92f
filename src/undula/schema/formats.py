"""The names of the formats of stored results, each with its number."""

#: Of a run.
RUN_FORMAT = "run 1"
