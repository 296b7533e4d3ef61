"""Where numbers come from, for every file of a run: hashes of scene and mesh, versions of what computed them."""

from __future__ import annotations

import hashlib
import json

from workflows.results import resolved
from workflows.solve.records import Results
from workflows.versions import versions as versions


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


def line(results: Results) -> str:
    """All in one line of text, for files that take a remark."""
    given, found = (", ".join(f"{name} {value}" for name, value in d.items()) for d in (hashes(results), versions()))
    return f"{given}; {found}"
