"""Where numbers come from, for every file of a run: hashes of scene and mesh, versions of what computed them."""

from __future__ import annotations

import hashlib
import json
import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

from workflows.results import resolved
from workflows.solve.records import Results

_PACKAGES = ("spindamp", "numpy", "scipy", "scikit-fem", "meshio", "numba")


def scene_sha256(results: Results) -> str:
    """SHA-256 of the resolved scene in its canonical form: JSON in UTF-8, keys sorted, no spaces, SI.

    The same scene, however it was written, has the same hash. A mesh file counts by its name here; its bytes have a
    hash of their own.
    """
    scene = resolved.scene(results.scene, results.effects, results.theory)
    canonical = json.dumps(scene, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
    return hashlib.sha256(canonical.encode()).hexdigest()


def hashes(results: Results) -> dict[str, str]:
    """What this was computed from, by the names that every file gives them."""
    found = {"scene_sha256": scene_sha256(results)}
    return found if results.mesh_sha256 is None else found | {"mesh_sha256": results.mesh_sha256}


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
    """All in one line of text, for files that take a remark."""
    given, found = (", ".join(f"{name} {value}" for name, value in d.items()) for d in (hashes(results), versions()))
    return f"{given}; {found}"
