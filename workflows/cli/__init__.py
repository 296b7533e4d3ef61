"""The command line, and nothing that it alone could do.

May import every room.
"""

from workflows.cli.main import main

__all__ = ["main"]
