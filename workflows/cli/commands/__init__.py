"""The commands of `spindamp`, a module each. A new command is a module with one function, named in COMMANDS."""

COMMANDS = (
    *("run", "campbell", "ringdown", "response", "reproduce", "accuracy", "effects"),
    *("sweep", "design", "view", "check"),
)
"""Modules of this package; the function of a command has the module's name. The order is that of --help."""

__all__ = ["COMMANDS"]
