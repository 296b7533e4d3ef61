"""Stamps: files that say what was checked on this machine, for some sources, versions and processor."""

from __future__ import annotations

import contextlib
import hashlib
import os
from pathlib import Path


def stamp(name: str, package: Path, versions: tuple[str, ...], folder: Path | None = None) -> Path:
    """The file whose existence says that something was checked.

    Args:
        name: what was checked.
        package: folder of the sources that it depends on.
        versions: of what else it depends on.
        folder: where stamps stand; None: beside the compiled sources, or in the user's cache if that cannot be written.
    """
    digest = hashlib.sha256(repr(versions).encode())
    for path in sorted(package.rglob("*.py")):
        digest.update(path.relative_to(package).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    if folder is None:
        folder = package / "__pycache__"
        if not os.access(folder, os.W_OK):
            folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "spindamp"
    return folder / f"{name}.{digest.hexdigest()[:16]}.checked"


def leave(path: Path) -> None:
    """Leave a stamp in place of older ones; where that fails, the next start checks again."""
    with contextlib.suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        for older in path.parent.glob(f"{path.name.split('.')[0]}.*.checked"):
            older.unlink(missing_ok=True)
        path.touch()
