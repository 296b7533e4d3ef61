"""How long what a test starts may take."""

HANG = 200.0
"""Seconds after which a process counts as hanging; below the limit of a test in pyproject.toml, so that it is named."""
