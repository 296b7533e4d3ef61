"""Where compiled code cannot be kept, every start compiles anew; nothing fails."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tests.compiler import needs_compiler
from tests.limits import HANG

NOWHERE = """
from numba.core.caching import CacheImpl
CacheImpl._locator_classes = []
from damper import compiled
import damper.engine
print(compiled.CACHED, compiled.kernel(lambda x: x + 1)(2))
"""


@needs_compiler
def test_no_place_for_compiled_code() -> None:
    """As where neither the package's folder nor a home can be written: numba then refuses to decorate with a cache."""
    done = subprocess.run([sys.executable, "-c", NOWHERE], capture_output=True, text=True, check=False, timeout=HANG)
    assert (done.returncode, done.stdout, done.stderr) == (0, "False 3\n", "")


FRESH = """
from damper import compiled
print(compiled.fresh())
from damper.events import _safe  # a kernel that calls no other compiles soon
_safe(1.0, 1.0, 1.0, 1.0, 1.0)
print(compiled.fresh())
"""


@needs_compiler
def test_the_first_start_of_an_installation_is_known(tmp_path: Path) -> None:
    """Numba keeps what it compiles in the folder that this variable names."""
    kept = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path)}
    done = subprocess.run(
        [sys.executable, "-c", FRESH], capture_output=True, text=True, check=False, timeout=HANG, env=kept
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "True\nFalse\n", "")
