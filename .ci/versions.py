"""The numbers with the newest and the lowest versions of what spindamp needs, on every Python installed here.

    .venv/bin/python .ci/versions.py

The first environment is `.venv`, which `go.py test` makes with the versions of `constraints.txt`. Every other Python
from 3.11 on gets the newest versions (where there is no other, this one does), the oldest Python also the lowest that
`pyproject.toml` names. Each must print the paper's headline and Table II to the same digits, without a warning, and
pass mypy. The newest versions on the newest Python, and the lowest, pass the tests of damper and plate; the others
those of ring-downs: by an independent reference, by laws and by closed forms.
"""

import difflib
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
OLDEST = (3, 11)
RESOLUTIONS = {"newest": "highest", "lowest": "lowest-direct"}
WHOLE = ("tests/damper", "tests/fem")
RINGDOWNS = ("tests/damper/test_reference.py", "tests/damper/test_invariants.py", "tests/damper/test_physics.py")
MAKING, COMPILING, PRINTING, TESTING = 600, 600, 600, 1800
"""Most seconds that a step may take."""

LEFT_OUT = shutil.ignore_patterns(".git", ".venv", ".*_cache", "__pycache__", "_build", "*.egg-info")
ABOUT = "import sys, sysconfig; print(*sys.version_info[:2], sysconfig.get_config_var('Py_GIL_DISABLED') or 0)"
INSTALLED = """
from importlib.metadata import version
print(*(f"{name} {version(name)}" for name in ("numpy", "scipy", "numba", "vtk", "zarr", "mypy")), sep=", ")
"""


class Failure(Exception):
    """A step that failed: why, in one line, and what it printed."""


class Environment(NamedTuple):
    """A copy of the tree with versions of its own in .venv."""

    name: str
    base: str
    versions: str
    place: Path
    tests: tuple[str, ...]

    @property
    def python(self) -> str:
        """The interpreter of .venv."""
        return str(self.place / ".venv" / "bin" / "python")


def main() -> int:
    """Check all environments; return the exit status."""
    os.environ["OMP_NUM_THREADS"] = "1"
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda number, _: sys.exit(128 + number))
    own, bases = sys.version_info[:2], interpreters()
    for version, base in bases.items():
        print("Python {}.{}: {}".format(*version, base), flush=True)
    plans = [(version, "newest") for version in bases if version != own] or [(own, "newest")]
    failed = []
    with tempfile.TemporaryDirectory(prefix="spindamp-versions-") as folder:
        environments = []
        for version, versions in [*plans, (min(bases), "lowest")]:
            name = "Python {}.{} with the {} versions".format(*version, versions)
            place = Path(folder, "{}.{}-{}".format(*version, versions))
            ends = versions == "lowest" or version == max(plans)[0]
            environments.append(Environment(name, bases[version], versions, place, WHOLE if ends else RINGDOWNS))
        try:
            make(Path(folder), environments)
            expected = figures(ROOT, sys.executable)
        except Failure as failure:
            return fail(failure)
        for environment in environments:
            began = time.monotonic()
            print(f"\n== {environment.name}", flush=True)
            try:
                check(environment, expected)
            except Failure as failure:
                failed.append(environment.name)
                fail(failure)
            print(f"{time.monotonic() - began:.0f} s", flush=True)
    print("\n== {}".format("failed: " + ", ".join(failed) if failed else "all passed"))
    return 1 if failed else 0


def interpreters() -> dict[tuple[int, int], str]:
    """An interpreter of each minor version, ascending: this one, else the first on PATH, else of pyenv."""
    on_path = [python for folder in os.get_exec_path() for python in sorted(Path(folder).glob("python3.*"))]
    of_pyenv = sorted(Path.home().glob(".pyenv/versions/*/bin/python"))
    bases = {sys.version_info[:2]: sys.executable}
    for python in [*(path for path in on_path if re.fullmatch(r"python3\.\d+", path.name)), *of_pyenv]:
        about = subprocess.run([python, "-c", ABOUT], capture_output=True, text=True, check=False).stdout.split()
        if len(about) == 3 and about[2] == "0":  # neither a shim without a Python nor one without the lock
            bases.setdefault((int(about[0]), int(about[1])), str(python))
    return {version: bases[version] for version in sorted(bases) if version >= OLDEST}


def make(folder: Path, environments: list[Environment]) -> None:
    """Copy the tree and install the versions, in all environments at once."""
    uv, no_network = str(folder / "uv" / "bin" / "uv"), "this needs the package index: is there a network?"
    together(folder, MAKING, [sys.executable, "-m", "venv", "uv"])
    together(folder, MAKING, ["uv/bin/python", "-m", "pip", "install", "--quiet", "uv"], hint=no_network)
    for each in environments:
        shutil.copytree(ROOT, each.place, ignore=LEFT_OUT)
    venv, install = [uv, "venv", "-q", "--python"], [uv, "pip", "install", "-q", "--resolution"]
    together(folder, MAKING, *([*venv, each.base, f"{each.place}/.venv"] for each in environments))
    rest = [[RESOLUTIONS[each.versions], "--python", each.python, "-e", f"{each.place}[test]"] for each in environments]
    together(folder, MAKING, *([*install, *arguments] for arguments in rest), hint=no_network)


def check(environment: Environment, expected: list[str]) -> None:
    """Kernels, types, the paper's figures and the tests."""
    place, python = environment.place, environment.python
    print(*together(place, PRINTING, [python, "-c", INSTALLED]), end="", flush=True)
    together(place, COMPILING, [python, "-W", "error", "-m", "tests.kernels_ready"], [python, "-m", "mypy"])
    here = figures(place, python)
    if here != expected:
        changes = difflib.unified_diff(expected, here, "with constraints.txt", "here", lineterm="", n=0)
        raise Failure("other figures than with the versions of constraints.txt", "\n".join(changes))
    pytest = [python, "-m", "pytest", "-q", "-n", "auto"]
    print(together(place, TESTING, [*pytest, *environment.tests])[0].splitlines()[-1])


def figures(place: Path, python: str) -> list[str]:
    """Headline and table of the paper's run as printed, and the claims of its Table II to four digits."""
    spindamp = [python, "-W", "error", "-m", "workflows.cli"]
    with tempfile.TemporaryDirectory(prefix="spindamp-figures-") as out:
        (run,) = together(place, PRINTING, [*spindamp, "run", "paper", "--out", f"{out}/paper"])
    (text,) = together(place, PRINTING, [*spindamp, "reproduce", "--json"])
    claims = json.loads(text, parse_float=lambda number: f"{float(number):.4g}")["claims"]
    table = [json.dumps(claim, ensure_ascii=False) for claim in claims if claim["id"].startswith("T2-")]
    return [*run.splitlines()[:-1], *table]  # the last line has the seconds


def together(place: Path, limit: float, *commands: list[str], hint: str = "") -> list[str]:
    """Output of commands that run at once; what is not done within the limit (s) is ended with all that it started.

    Raises:
        Failure: one of them fails or takes longer.
    """
    until, started, outputs = time.monotonic() + limit, [], []
    with tempfile.TemporaryDirectory(prefix="spindamp-output-") as folder:
        try:
            for number, command in enumerate(commands):
                with Path(folder, f"{number}").open("w") as out, Path(folder, f"{number}.err").open("w") as err:
                    streams = {"stdin": subprocess.DEVNULL, "stdout": out, "stderr": err}
                    started.append(subprocess.Popen(command, cwd=place, start_new_session=True, **streams))
            for number, (process, command) in enumerate(zip(started, commands, strict=True)):
                try:
                    ending = f"ended with status {process.wait(max(until - time.monotonic(), 0.0))}"
                except subprocess.TimeoutExpired:
                    ending = f"took more than {limit} s"
                output, errors = (Path(folder, f"{number}{kind}").read_text("utf-8") for kind in ("", ".err"))
                if process.returncode != 0:
                    raise Failure("; ".join(filter(None, (f"{' '.join(command)} {ending}", hint))), output + errors)
                outputs.append(output)
        finally:
            for process in started:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
    return outputs


def fail(failure: Failure) -> int:
    """Print what a step printed and why it failed; return the exit status."""
    why, printed = failure.args
    print(f"{printed.strip()}\nversions.py: {why}", file=sys.stderr, flush=True)
    return 1


if __name__ == "__main__":
    sys.exit(main())
