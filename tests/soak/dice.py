"""Where random numbers come from: a seeded generator here, a search for counterexamples in the property tests."""

from collections.abc import Sequence
from typing import Protocol, TypeVar

import numpy as np

T = TypeVar("T")


class Dice(Protocol):
    """Draws values."""

    def between(self, low: float, high: float) -> float:
        """A number from low to high."""
        ...

    def one_of(self, choices: Sequence[T]) -> T:
        """One of the choices."""
        ...


class Seeded:
    """Dice that fall alike for the same seed."""

    def __init__(self, seed: int | tuple[int, ...]) -> None:
        self._rng = np.random.default_rng(seed)

    def between(self, low: float, high: float) -> float:
        return float(self._rng.uniform(low, high))

    def one_of(self, choices: Sequence[T]) -> T:
        return choices[int(self._rng.integers(len(choices)))]


def power(dice: Dice, low: float, high: float) -> float:
    """Ten to a power from low to high."""
    return float(10.0 ** dice.between(low, high))


def sometimes(dice: Dice, special: Sequence[float], otherwise: float) -> float:
    """Half the time one of the special values."""
    return dice.one_of(special) if dice.one_of((True, False)) else otherwise
