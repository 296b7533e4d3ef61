"""The versions that the tests are known to pass with: on every Python that the package names, and in its ranges."""

import itertools
import runpy
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
LISTS = (PROJECT["dependencies"], *PROJECT["optional-dependencies"].values())
ASKED = [Requirement(text) for text in itertools.chain(*LISTS)]
NAMED = "Programming Language :: Python :: 3."
PYTHONS = [f"3.{name.removeprefix(NAMED)}" for name in PROJECT["classifiers"] if name.startswith(NAMED)]


def test_the_oldest_python_is_named():
    assert PROJECT["requires-python"] == f">={PYTHONS[0]}"


@pytest.mark.parametrize("python", PYTHONS)
def test_one_known_version_is_in_range(python):
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    known = [Requirement(line) for line in lines if not line.lstrip().startswith("#")]
    here = {"python_version": python, "python_full_version": f"{python}.9", "sys_platform": "linux"}
    for asked in ASKED:
        same = [each for each in known if canonicalize_name(each.name) == canonicalize_name(asked.name)]
        (version,) = (each.specifier for each in same if each.marker is None or each.marker.evaluate(here))
        (pinned,) = version
        assert pinned.operator == "==", asked
        assert asked.specifier.contains(pinned.version), asked


def test_go_installs_the_known_versions(tmp_path, monkeypatch):
    """Once, and again where these or the ranges change."""
    for name in ("go.py", "pyproject.toml", "constraints.txt"):
        shutil.copy(ROOT / name, tmp_path)
    go = runpy.run_path(str(tmp_path / "go.py"))
    go["PYTHON"].parent.mkdir(parents=True)
    go["PYTHON"].touch()
    installs = []

    def run(command, check):
        if "pip" in command:
            installs.append([str(part) for part in command])

    monkeypatch.setattr(subprocess, "run", run)
    for _ in range(2):
        go["install"]("[test]")
    assert len(installs) == 1
    assert installs[0][-4:] == ["-c", str(tmp_path / "constraints.txt"), "-e", f"{tmp_path}[test]"]
    for name in ("constraints.txt", "pyproject.toml"):
        with (tmp_path / name).open("a", encoding="utf-8") as file:
            file.write("# newer\n")
        go["install"]("[test]")
    assert len(installs) == 3
