"""What keeps the tests themselves within bounds: none hangs for ever, and none takes more than one core."""

import os
import tomllib
from pathlib import Path

import pytest

from tests.limits import HANG
from tests.workflows.conftest import python

ROOT = Path(__file__).parents[1]

IN_PYTHON = "import time\n\ndef test_hangs():\n    time.sleep(600)\n"
IN_NATIVE_CODE = "import ctypes\n\ndef test_hangs():\n    ctypes.PyDLL(None).sleep(600)\n"  # which holds the lock


def test_every_test_has_a_limit() -> None:
    options = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["pytest"]["ini_options"]
    assert HANG < options["timeout"] < options["faulthandler_timeout"]
    assert options["faulthandler_exit_on_timeout"]


@pytest.mark.parametrize(
    ("code", "limit", "said"),
    [
        (IN_PYTHON, "timeout=1", "Timeout (>1.0s) from pytest-timeout"),
        pytest.param(
            IN_NATIVE_CODE,
            "faulthandler_timeout=1",
            "Timeout (0:00:01)!",
            marks=pytest.mark.skipif(os.name == "nt", reason="Windows has no sleep() to call"),
        ),
    ],
)
def test_a_hanging_test_ends(code: str, limit: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text(code)
    options = ("-c", ROOT / "pyproject.toml", "-p", "no:cacheprovider", "-o", limit)
    done = python("-m", "pytest", *options, tmp_path, cwd=tmp_path)
    assert done.returncode == 1
    assert said in done.stdout + done.stderr


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="counts threads in /proc")
def test_what_a_test_starts_takes_one_core() -> None:
    code = "import os, numpy as np\na = np.ones((500, 500))\na @ a\nprint(len(os.listdir('/proc/self/task')))"
    done = python("-c", code)
    assert int(done.stdout) == int(os.environ["OMP_NUM_THREADS"])
