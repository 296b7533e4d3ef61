"""Which code computes: a digest of every module, and the versions of what they rest on."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from workflows.errors import BadInput
from workflows.versions import versions

_PACKAGES = ("fem", "damper", "workflows")
_ROOT = Path(__file__).parents[3]


@cache
def digest() -> str:
    """SHA-256 of the sources of all packages, names and contents."""
    found = hashlib.sha256()
    for package in _PACKAGES:
        for path in sorted((_ROOT / package).rglob("*.py")):
            found.update(path.relative_to(_ROOT).as_posix().encode() + b"\0")
            found.update(path.read_bytes() + b"\0")
    return found.hexdigest()


def same(other: str) -> None:
    """See that a worker runs the code that the study is of.

    Raises:
        BadInput: it does not.
    """
    if digest() != other:
        raise BadInput("a worker has other code than the study: install the same version everywhere", key="sweep")


def identity() -> dict[str, str]:
    """The code by its digest, and versions; what differs in any of them may differ in its last bits."""
    return {"sources_sha256": digest()} | versions()
