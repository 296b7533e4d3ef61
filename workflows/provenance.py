"""Where numbers come from: the hash of the scene and the versions that computed them, for every file of a run."""

from __future__ import annotations

import hashlib
import json
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from workflows import resolved
from workflows.records import Results

_PACKAGES = ("spindamp", "numpy", "scipy", "scikit-fem", "meshio", "numba")


def scene_sha256(results: Results) -> str:
    """SHA-256 of the resolved scene in its canonical form: JSON in UTF-8, keys sorted, no spaces, SI.

    The same scene, however it was written, has the same hash; a mesh file counts by its name.
    """
    scene = resolved.scene(results.scene, results.effects, results.theory)
    canonical = json.dumps(scene, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


@cache
def _versions() -> tuple[tuple[str, str], ...]:
    found = [("python", platform.python_version())]
    for package in _PACKAGES:
        try:
            found.append((package, version(package)))
        except PackageNotFoundError:
            found.append((package, "not installed"))
    return tuple(found)


def versions() -> dict[str, str]:
    """What computed this."""
    return dict(_versions())


def line(results: Results) -> str:
    """Both in one line of text, for files that take a remark."""
    found = ", ".join(f"{name} {number}" for name, number in versions().items())
    return f"scene_sha256 {scene_sha256(results)}; {found}"
