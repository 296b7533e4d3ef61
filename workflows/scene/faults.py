"""What is wrong with values together, said with the key to look at."""

from __future__ import annotations

from pydantic_core import PydanticCustomError

ROUNDING = 1e-9
"""Relative slack of comparisons between values, which come from decimal text."""


def fault(key: str, problem: str) -> PydanticCustomError:
    """An error at `key` (relative to the table, or ``table.key`` for the whole scene)."""
    return PydanticCustomError("together", "{problem}", {"problem": problem, "key": key})
