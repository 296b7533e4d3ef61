"""Whether kernels are compiled here; NUMBA_DISABLE_JIT=1 runs them as plain Python, a hundred times slower."""

import numba
import pytest

COMPILED = not numba.config.DISABLE_JIT

needs_compiler = pytest.mark.skipif(not COMPILED, reason="takes minutes without the compiler")


def some(full: int, without: int) -> range:
    """Seeds 0, 1, ...: fewer of them without the compiler."""
    return range(full if COMPILED else without)
