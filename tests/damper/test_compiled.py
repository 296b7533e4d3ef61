"""Where compiled code cannot be kept, every start compiles anew; nothing fails."""

from __future__ import annotations

import subprocess
import sys

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
