"""Compiled code is kept where it can be, never used for other sources, and compiled anew where it cannot be read."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from damper import compiled
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
import numpy as np
from damper.impacts import restitutions  # a small kernel compiles soon
from damper.state import BALL
restitutions(np.ones(1), np.ones(1, BALL)[0], np.ones(1))
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


KEPT = """
import numpy as np
from damper.impacts import restitutions
from damper.state import BALL
ratios = np.zeros(1)
restitutions(np.ones(1), np.full(1, 0.5, BALL)[0], ratios)
print(ratios[0], *restitutions.stats.cache_hits.values())
"""


def kept_in(folder: Path, tree: Path | None = None) -> str:
    """What a start says whose compiled code is kept in a folder; `tree`: of its sources, if they are not these."""
    done = subprocess.run(
        [sys.executable, "-c", KEPT],
        capture_output=True,
        text=True,
        check=False,
        timeout=HANG,
        env={**os.environ, "NUMBA_CACHE_DIR": str(folder)},
        cwd=tree,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


@needs_compiler
def test_files_that_are_cut_off_are_compiled_anew(tmp_path: Path) -> None:
    first = kept_in(tmp_path)
    for ending in ("nbi", "nbc"):
        for file in tmp_path.rglob(f"*.{ending}"):
            file.write_bytes(file.read_bytes()[:-20])
        assert kept_in(tmp_path) == first
    value, *hits = kept_in(tmp_path).split()
    assert (value, hits) == (first.split()[0], ["1"])


@needs_compiler
def test_code_of_other_sources_is_dropped(tmp_path: Path) -> None:
    """Wherever it is kept: a kernel that did not change itself may call one that did."""
    tree, kept = tmp_path / "tree", tmp_path / "kept"
    shutil.copytree(Path(compiled.__file__).parent, tree / "damper", ignore=shutil.ignore_patterns("__pycache__"))
    assert "1" not in kept_in(kept, tree).split()[1:]
    assert kept_in(kept, tree).split()[1:] == ["1"]
    other = tree / "damper" / "impacts.py"
    times = other.stat()
    other.write_text(other.read_text() + "\n# another\n")
    os.utime(other, ns=(times.st_atime_ns, times.st_mtime_ns))
    assert "1" not in kept_in(kept, tree).split()[1:]
    assert kept_in(kept, tree).split()[1:] == ["1"]


@needs_compiler
def test_a_part_of_kernels_is_not_called_from_python() -> None:
    """There is no way in compiled for that: a call would end the process."""
    doubled = compiled.part(lambda x: 2 * x)
    assert compiled.kernel(lambda x: doubled(x) + 1)(2) == 5
    with pytest.raises(TypeError, match="is a part of kernels"):
        doubled(2)
