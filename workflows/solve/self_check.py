"""The self-check: reference plates and reference motions, before a machine's first results and when it is asked for."""

from __future__ import annotations

import platform
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

from workflows import versions


@cache
def plates() -> None:
    """Check the plates unless that was done on this machine; the damper's kernels see to themselves.

    Raises:
        LawViolation: a frequency differs from its reference.
    """
    from damper.self_check import leave
    from fem.sweep import reference

    path = stamp_of_plates()
    if not path.exists():
        reference.check()
        leave(path)


def stamp_of_plates() -> Path:
    """Where it stands that the plates were checked."""
    import fem
    from damper.self_check import stamp

    return stamp("plates", Path(fem.__file__).parent, (platform.machine(), platform.node(), versions.line()))


def report() -> tuple[list[str], bool]:
    """A line for every check, versions first, and whether all passed."""
    found, passed = [versions.line()], True
    for family, results in _families().items():
        try:
            for line, right in results():
                passed &= right
                found.append(f"{'ok' if right else 'WRONG'}  {line}")
        except Exception as error:
            passed = False
            found.append(f"WRONG  {family}: {error}")
    return [*found, "all checks passed" if passed else "do not trust results of this installation"], passed


def _families() -> dict[str, Callable[[], Iterator[tuple[str, bool]]]]:
    """What computes the lines of each family, and whether each is right."""
    from damper import forced, ringdown, self_check
    from damper.working import samples_of

    runs: dict[str, Any] = {"forced": forced, "level sweeps": samples_of, "linear sweeps": samples_of}

    def kernels(family: str) -> Iterator[tuple[str, bool]]:
        for line in self_check.lines(family, runs.get(family, ringdown)):
            said = f"{line.name}: {line.figure} {line.value:.11g}, reference {line.reference:.11g}"
            yield f"{said}, error {line.error:.1e}", line.error <= self_check.EXACT

    def of(family: str) -> Callable[[], Iterator[tuple[str, bool]]]:
        return lambda: kernels(family)

    return {"plates": _plates} | {family: of(family) for family in self_check.FAMILIES}


def _plates() -> Iterator[tuple[str, bool]]:
    from fem.sweep import reference

    for line in reference.lines():
        said = f"{line.name}: {line.value:.8g}, reference {line.reference:.8g}, error {line.error:.1e}"
        yield said, line.error <= line.allowed
