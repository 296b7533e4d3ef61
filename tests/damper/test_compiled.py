"""Compiled code is kept where it can be, never used for other sources, and compiled anew where it cannot be read."""

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from damper import compiled
from tests.compiler import needs_compiler
from tests.limits import HANG


def python(code: str, **how: Any) -> subprocess.CompletedProcess[str]:
    """What a process of its own does with code."""
    how |= {"capture_output": True, "text": True, "check": False, "timeout": HANG}
    return subprocess.run([sys.executable, "-c", code], **how)


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
    done = python(NOWHERE)
    assert (done.returncode, done.stdout, done.stderr) == (0, "False 3\n", "")


KEPT = """
from damper import compiled
import numpy as np
from damper.impacts import restitutions  # a small kernel compiles soon
from damper.state import BALL
before, ratios = compiled.fresh(), np.zeros(1)
restitutions(np.ones(1), np.full(1, 0.5, BALL)[0], ratios)
print(ratios[0], before, compiled.fresh(), sum(restitutions.stats.cache_hits.values()))
"""


@needs_compiler
def test_what_is_kept_is_used_if_it_is_whole_and_of_these_sources(tmp_path: Path) -> None:
    """Wherever it is kept: a kernel that did not change itself may call one that did."""
    tree, kept = tmp_path / "tree", tmp_path / "kept"
    shutil.copytree(Path(compiled.__file__).parent, tree / "damper", ignore=shutil.ignore_patterns("__pycache__"))

    def start() -> list[str]:
        """Value; whether this is the first start, before and after; how much was read. Numba keeps all in `kept`."""
        done = python(KEPT, env={**os.environ, "NUMBA_CACHE_DIR": str(kept)}, cwd=tree)
        assert (done.returncode, done.stderr) == (0, "")
        return done.stdout.split()

    value, *first = start()
    assert first == ["True", "False", "0"]
    for ending in ("nbi", "nbc"):
        for file in kept.rglob(f"*.{ending}"):
            file.write_bytes(file.read_bytes()[:-20])
        assert start() == [value, "False", "False", "0"], "compiled anew"
    other = tree / "damper" / "impacts.py"
    times = other.stat()
    other.write_text(other.read_text() + "\n# another\n")
    os.utime(other, ns=(times.st_atime_ns, times.st_mtime_ns))
    assert start()[-1] == "0"
    assert start() == [value, "False", "False", "1"]


@needs_compiler
def test_a_part_of_kernels_is_not_called_from_python() -> None:
    """There is no way in compiled for that: a call would end the process."""
    doubled = compiled.part(lambda x: 2 * x)
    assert compiled.kernel(lambda x: doubled(x) + 1)(2) == 5
    with pytest.raises(TypeError, match="is a part of kernels"):
        doubled(2)
