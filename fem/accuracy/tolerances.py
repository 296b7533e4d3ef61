"""Error budget: how much each step of a computation may add to the error of a frequency."""

from dataclasses import dataclass

EXACT = 1e-3
"""Part of a mesh's tolerance to which its own squared frequencies are solved for."""

FIRST, SURE = 0.6, 0.75
"""Part of its tolerance that a mesh's estimate must meet while it rests on two meshes, its order not measured, and
after."""

_TAKEN = 0.65
"""Part of its tolerance that the error of a chosen mesh takes, for these reasons."""

_LEAST_OF_THE_MESH = 0.25
"""Least part of the accuracy asked for that a mesh is chosen by."""

_LEAST_BASIS = 1e-7
"""Error of a reduced basis below which it would be lost in rounding."""


@dataclass(frozen=True)
class Budget:
    """Relative errors asked for, and what each cause may add to them.

    What is added up is the estimate beside every frequency; the mesh has what the others leave.

    Attributes:
        frequency: of a frequency, as a whole.
        damping: of the damping.
    """

    frequency: float
    damping: float = 1e-3

    @property
    def thin(self) -> float:
        """That thin-plate theory may be off by."""
        return 0.5 * self.frequency

    @property
    def sheared(self) -> float:
        """That Mindlin's theory may be off by, the last that is cheap."""
        return 0.75 * self.frequency

    @property
    def layers(self) -> float:
        """That the layers of a solid may leave."""
        return 0.5 * self.frequency

    @property
    def basis(self) -> float:
        """That the reduced basis which answers many speeds may add."""
        return max(1e-3 * self.frequency, _LEAST_BASIS)

    def mesh(self, theory: float, left_out: float) -> float:
        """Tolerance for the choice of a mesh, less what theory and effects left out take of it.

        Where these take much, all of it is left to the mesh.
        """
        left = self.frequency - theory - left_out
        return min(left / _TAKEN, self.frequency) if left >= _LEAST_OF_THE_MESH * self.frequency else self.frequency

    @property
    def left_out(self) -> float:
        """Shift by an effect that is left out; found on a coarse mesh, it is good to a few percent of itself."""
        return 0.95 * self.frequency

    @property
    def rough_shift(self) -> float:
        """The same where the plate is known as a beam only, or the mesh is given and has most of the error."""
        return 0.1 * self.frequency

    @property
    def drive(self) -> float:
        """Share of the ball's drive that may be left out."""
        return self.damping

    @property
    def rough_drive(self) -> float:
        """The same where the plate is known as a beam only."""
        return 0.1 * self.damping

    @property
    def scattered(self) -> float:
        """Mass of the ball over that of a mode left out, at the cavity.

        Such a mode changes the damping by 1.75 times that at most, 0.15 times in the median
        (`python -m tests.benchmarks.modes_needed`).
        """
        return 0.5 * self.damping
