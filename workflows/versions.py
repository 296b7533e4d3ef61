"""The versions of the programs behind a number."""

from __future__ import annotations

import platform
from functools import cache
from importlib.metadata import PackageNotFoundError, version

_PACKAGES = ("spindamp", "numpy", "scipy", "scikit-fem", "meshio", "numba", "llvmlite")


@cache
def _versions() -> tuple[tuple[str, str], ...]:
    versions = [("python", platform.python_version())]
    for package in _PACKAGES:
        try:
            versions.append((package, version(package)))
        except PackageNotFoundError:
            versions.append((package, "not installed"))
    return tuple(versions)


def versions() -> dict[str, str]:
    """Versions by name, of Python first."""
    return dict(_versions())


def line() -> str:
    """All of them in one line."""
    return ", ".join(f"{name} {number}" for name, number in _versions())
