"""The versions of the programs behind a number."""

import platform
from functools import cache

_PACKAGES = ("spindamp", "numpy", "scipy", "scikit-fem", "meshio", "meshlane", "numba", "llvmlite")


@cache
def versions() -> dict[str, str]:
    """Versions by name, of Python first."""
    from importlib.metadata import PackageNotFoundError, version  # a tenth of a light command

    known = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            known[package] = version(package)
        except PackageNotFoundError:
            known[package] = "not installed"
    return known


def line() -> str:
    """All of them in one line."""
    return ", ".join(f"{name} {number}" for name, number in versions().items())
