"""The program `undula` as a module, for ``python -m undula``."""

import sys

from undula.app.start import main

if __name__ == "__main__":
    sys.exit(main())
