"""The damper's compiled kernels: compiled by one process of a machine, before the others ask for them.

Processes that fill the compiler's cache at the same time get into each other's way (numba, issues 4807 and 10128).
"""

from __future__ import annotations

import os
import tempfile
from functools import cache
from pathlib import Path

from workflows.studies.sweep import fingerprint


@cache
def ready() -> None:
    """Compile all kernels, or load them: the first process of a machine alone, the others once it is done."""
    from filelock import FileLock

    user = getattr(os, "getuid", lambda: 0)()
    place = Path(tempfile.gettempdir()) / f"spindamp-{user}-{_digest()}"
    done = place.with_suffix(".compiled")
    if done.exists():
        return
    with FileLock(place.with_suffix(".lock")):
        if not done.exists():
            compile_all()
            done.touch()


def compile_all() -> None:
    """Run everything once, on level and on tilting floors, left alone and driven."""
    from damper import Harmonic, ParticleDamper, backbone, forced, ringdowns, working

    level = ParticleDamper(
        modal_mass=1.0,
        stiffness=(1e6, 1e6),
        ball_mass=1e-2,
        ball_radius=1e-3,
        cavity=(3e-3, 3e-3),
        centrifugal_acceleration=1e3,
        restitution=0.5,
        friction=0.3,
        rolling_friction=1e-5,
    )
    for damper in (level, ParticleDamper(**vars(level) | {"floor_tilt": (1.0, 0.0)})):
        working(damper, threads=1, sweeps=2, stay=1)
        ringdowns(damper, [(1e-3, 0.0)], 1, threads=1)
        backbone(damper, threads=1)
        forced(damper, [Harmonic(1e3, force=(1.0, 0.0))], threads=1, max_cycles=32)


def _digest() -> str:
    """Of the code and of where it lies: an installation has a cache of its own."""
    import hashlib

    return hashlib.sha256(f"{fingerprint.digest()} {Path(__file__).resolve()}".encode()).hexdigest()[:16]
