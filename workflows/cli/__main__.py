"""`python -m workflows.cli`."""

import sys

from workflows.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
