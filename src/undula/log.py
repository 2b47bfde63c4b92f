"""Loggers of the package, which write nothing unless the program that uses it asks for it."""

import logging

_NAME = "undula"
# Without a handler of its own, the standard library would write warnings to standard error.
logging.getLogger(_NAME).addHandler(logging.NullHandler())


def logger(module: str) -> logging.Logger:
    """Return the logger of a module, below the logger "undula".

    Parameters
    ----------
    module
        Name of the module in the package.

    Examples
    --------
    >>> from undula.log import logger
    >>> logger("undula.analysis").parent.name
    'undula'
    """
    return logging.getLogger(module)
