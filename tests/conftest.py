"""Settings shared by all tests."""

import os

from hypothesis import settings

# No screen is needed, and none is looked for.
os.environ.setdefault("MPLBACKEND", "Agg")

# As on the command line, see `undula.app.cli`.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# The first call of a kernel compiles it, which no deadline per example could allow for.
settings.register_profile("undula", deadline=None)
settings.load_profile("undula")
