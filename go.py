#!/usr/bin/env python3
"""From a fresh checkout and nothing but Python to results: makes .venv, installs the project there, runs it.

    python3 go.py run [ARGS]    runs `spindamp run ARGS`
    python3 go.py test [ARGS]   runs ruff, mypy and pytest on all cores (ARGS go to pytest)
    python3 go.py docs          builds the documentation into docs/_build, its examples run

Any other command is handed to spindamp: `python3 go.py check paper`.
"""

import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent
VENV = ROOT / ".venv"
BIN = VENV / ("Scripts" if os.name == "nt" else "bin")
OLDEST = (3, 11)
EXTRAS = ("test", "docs")
PACKAGES = ["spindamp.py", "fem", "damper", "workflows", "tests", "meshes", "go.py", ".ci"]


def program(name):
    """A program of .venv."""
    return BIN / (f"{name}.exe" if os.name == "nt" else name)


PYTHON, SPINDAMP = program("python"), program("spindamp")


def main(arguments):
    """Run a command; return its exit status."""
    if sys.version_info < OLDEST:
        return fail("needs Python {}.{} or newer, this is {}.{}".format(*OLDEST, *sys.version_info[:2]))
    if not arguments or arguments[0] in ("-h", "--help"):
        print(__doc__.strip())
        return 0 if arguments else 2
    command, rest = arguments[0], arguments[1:]
    try:
        install(f"[{command}]" if command in EXTRAS else "")
    except subprocess.CalledProcessError as error:
        return fail(f"the installation ended with status {error.returncode}; remove .venv to begin afresh")
    try:
        if command == "docs":
            status = call(PYTHON, "-m", "sphinx", "-E", "-W", "--keep-going", "-q", "docs", "docs/_build", *rest)
            if status == 0:
                print(f"open {ROOT / 'docs' / '_build' / 'index.html'}")
            return status
        return test(rest) if command == "test" else call(SPINDAMP, command, *rest)
    except KeyboardInterrupt:
        return 130


def test(arguments):
    """Lint, format, types, tests; all of them, even if one fails. Types are checked beside the tests, and said last."""
    os.environ.setdefault("OMP_NUM_THREADS", "1")  # the tests have all cores already
    kernels = subprocess.Popen([PYTHON, "-W", "error", "-m", "tests.kernels_ready"], cwd=ROOT)
    mypy = subprocess.Popen(
        [PYTHON, "-m", "mypy"], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    pytest = [PYTHON, "-m", "pytest", "-n", "auto", *arguments]

    def tests():
        kernels.wait()  # each process of pytest would compile them
        return call(*pytest)

    def types():
        print(mypy.communicate()[0], end="")
        return mypy.returncode

    steps = {
        "ruff check": lambda: call(PYTHON, "-m", "ruff", "check", *PACKAGES),
        "ruff format": lambda: call(PYTHON, "-m", "ruff", "format", "--check", *PACKAGES),
        "pytest": tests,
        "mypy": types,
    }
    failed = []
    for name, step in steps.items():
        print(f"\n== {name}", flush=True)
        if step() != 0:
            failed.append(name)
    print("\n== {}".format("failed: " + ", ".join(failed) if failed else "all passed"))
    return 1 if failed else 0


def install(extra):
    """Make .venv with the versions of constraints.txt, unless that was done for it and for this very pyproject.toml."""
    constraints = ROOT / "constraints.txt"
    wanted = hashlib.sha256((ROOT / "pyproject.toml").read_bytes() + constraints.read_bytes()).hexdigest()
    stamp = VENV / ".installed"
    done = stamp.read_text() if stamp.is_file() else ""
    if PYTHON.is_file() and done.startswith(wanted) and extra in done:
        return
    if not PYTHON.is_file():
        make_venv()
    print("installing spindamp into .venv (once, a minute or two)", file=sys.stderr, flush=True)
    pip = [PYTHON, "-m", "pip", "--disable-pip-version-check", "install", "--quiet"]
    subprocess.run([*pip, "-c", constraints, "-e", f"{ROOT}{extra}"], check=True)
    # as pip does for installed packages; Python itself would not where PYTHONDONTWRITEBYTECODE is set
    subprocess.run([PYTHON, "-m", "compileall", "-q", *(ROOT / name for name in PACKAGES[:4])], check=False)
    stamp.write_text((done if done.startswith(wanted) else wanted) + extra)


def make_venv():
    """Make .venv, or say what to install where Python came without the means."""
    try:
        import ensurepip  # noqa: F401
        import venv
    except ImportError:
        package = "python{}.{}-venv".format(*sys.version_info)
        sys.exit(fail(f"this Python cannot make virtual environments; on Debian: apt-get install {package}"))
    print("making .venv", file=sys.stderr, flush=True)
    try:
        venv.create(VENV, with_pip=True, clear=True)
    except (OSError, subprocess.CalledProcessError) as error:
        shutil.rmtree(VENV, ignore_errors=True)
        sys.exit(fail(f"cannot make .venv: {error}"))


def call(*command):
    """Run a command in the project's folder or, for spindamp, where the user is."""
    where = None if command[0] == SPINDAMP else ROOT
    return subprocess.run([os.fspath(part) for part in command], cwd=where, check=False).returncode


def fail(message):
    """Say what is wrong; return the exit status for it."""
    print(f"go.py: {message}", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
