"""The self-check: reference plates and reference motions, before a machine's first results and when it is asked for."""

import platform
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import fem
from damper import forced, ringdown, self_check
from damper.curve_measurement import falling, samples_of
from workflows import versions


@cache
def plates() -> None:
    """Check the plates unless that was done on this machine; the damper's kernels see to themselves.

    Raises:
        LawViolation: a frequency differs from its reference.
    """
    from fem.reduction import reference

    path = stamp_of_plates()
    if not path.exists():
        reference.check()
        self_check.leave(path)


def stamp_of_plates() -> Path:
    """Where it stands that the plates were checked."""
    return self_check.stamp("plates", Path(fem.__file__).parent, (platform.machine(), platform.node(), versions.line()))


def report() -> Iterator[str]:
    """A line for the versions, one for every check as soon as its family is done, and a last one: `ALL_PASSED` or not.

    Families that passed have their stamps then; as plain Python they have none, and long motions are left out.
    """
    from damper.compiled import COMPILES

    yield versions.line()
    passed = True
    kernels = [
        family
        for family, motions in self_check.FAMILIES.items()
        if COMPILES or motions.keys() <= self_check.RINGDOWNS.keys()
    ]
    for family in ("plates", *kernels):
        of_plates, right, lines = family == "plates", True, []
        try:
            for line, holds in _plates() if of_plates else _kernels(family):
                right &= holds
                lines.append(f"{'ok' if holds else 'WRONG'}  {line}")
        except Exception as error:
            right = False
            lines.append(f"WRONG  {family}: {error}")
        if right and (COMPILES or of_plates):
            self_check.leave(stamp_of_plates() if of_plates else self_check.stamp_of(family))
        passed &= right
        yield from lines
    if len(kernels) < len(self_check.FAMILIES):
        yield "not checked: damping curves and steady states, which take plain Python too long"
    yield ALL_PASSED if passed else "do not trust results of this installation"


ALL_PASSED = "all checks passed"


def _kernels(family: str) -> Iterator[tuple[str, bool]]:
    """The lines of a family of kernels, and whether each is right."""
    motions: dict[str, Callable[..., Any]] = {"sweeps": samples_of, "curves": falling, "forced": forced}
    for line in self_check.lines(family, motions.get(family.split()[-1], ringdown)):
        line_text = f"{line.name}: {line.figure} {line.value:.11g}, reference {line.reference:.11g}"
        yield f"{line_text}, error {line.error:.1e}", line.error <= self_check.EXACT


def _plates() -> Iterator[tuple[str, bool]]:
    from fem.reduction import reference

    for line in reference.lines():
        line_text = f"{line.name}: {line.value:.8g}, reference {line.reference:.8g}, error {line.error:.1e}"
        yield line_text, line.error <= line.allowed
