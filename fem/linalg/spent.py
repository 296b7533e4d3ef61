"""What factors, solutions with them and small dense matrices took: for whoever reckons what larger ones will take."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from time import perf_counter

_BOOKS: ContextVar[tuple[Spent, ...]] = ContextVar("books", default=())


@dataclass(eq=False)
class Spent:
    """How many factors and columns solved for, the seconds of either, and those for small dense matrices."""

    factors: int = 0
    columns: int = 0
    factoring: float = 0.0
    solving: float = 0.0
    projecting: float = 0.0


@contextmanager
def spent() -> Iterator[Spent]:
    """Books of what is done within."""
    found = Spent()
    token = _BOOKS.set((*_BOOKS.get(), found))
    try:
        yield found
    finally:
        _BOOKS.reset(token)


@contextmanager
def factoring() -> Iterator[None]:
    """A factor is made within."""
    began = perf_counter()
    yield
    took = perf_counter() - began
    for book in _BOOKS.get():
        book.factors += 1
        book.factoring += took


@contextmanager
def solving(columns: int) -> Iterator[None]:
    """So many columns are solved for within."""
    began = perf_counter()
    yield
    took = perf_counter() - began
    for book in _BOOKS.get():
        book.columns += columns
        book.solving += took


@contextmanager
def projecting() -> Iterator[None]:
    """What is done within hangs on how many vectors there are, not on their length: modes of a projected matrix."""
    began = perf_counter()
    yield
    took = perf_counter() - began
    for book in _BOOKS.get():
        book.projecting += took
