"""Run the tests against mutants of `damper`, and say which of them nobody noticed."""

import argparse
import ast
import contextlib
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from subprocess import DEVNULL, run

from tests.mutation.mutants import Mutant, mutants

ROOT = Path(__file__).parents[2]
TESTS = (
    "tests/damper/test_reference.py::test_known_digits",
    "tests/damper/test_physics.py",
    "tests/damper/test_kernels.py",
    "tests/damper/test_model.py",
    "tests/hard_cases/test_damper.py",
    "tests/damper/test_stepping.py",
    "tests/damper/test_batch.py",
)
"""Those that are quick without the compiler, the sharpest first."""
ASIDE = ("compiled.py", "vectors.py", "arrays.py", "__init__.py")
"""Files without physics."""
PATIENCE = 90
"""Seconds of processor time after which a mutant counts as hanging, and so as noticed."""


def main() -> int:
    """Try a sample of the mutants; print the score and the survivors."""
    parser = argparse.ArgumentParser(prog="python -m tests.mutation", description=__doc__)
    parser.add_argument("--sample", type=int, help="how many mutants to try; default: all")
    parser.add_argument("--seed", type=int, default=0, help="of the sample")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--only", default="", help="files whose name holds this")
    parser.add_argument("--out", type=Path, help="file for the survivors, one a line")
    given = parser.parse_args()
    files = [f for f in sorted((ROOT / "damper").glob("*.py")) if f.name not in ASIDE and given.only in f.name]
    every = [mutant for file in files for mutant in mutants(file)]
    chosen = random.Random(given.seed).sample(every, min(given.sample or len(every), len(every)))
    if not noticed_by_none():
        print("the tests fail without any mutant", file=sys.stderr)
        return 1
    survivors = []
    with ThreadPoolExecutor(given.jobs) as pool:
        for number, (mutant, killed) in enumerate(zip(chosen, pool.map(is_noticed, chosen), strict=True), 1):
            if not killed:
                survivors.append(mutant.name)
                print(f"[{number}/{len(chosen)}] survived: {mutant.name}", flush=True)
                if given.out:
                    given.out.write_text("".join(f"{name}\n" for name in sorted(survivors)))
    killed = len(chosen) - len(survivors)
    print(f"{killed} of {len(chosen)} mutants noticed ({100 * killed / len(chosen):.1f} %), of {len(every)} in all")
    return 0


def noticed_by_none() -> bool:
    """Whether the tests pass on the source as it is."""
    tree = ast.parse((ROOT / "damper" / "model.py").read_text())
    return not is_noticed(Mutant("model.py", tree, tree, tree))


def is_noticed(mutant: Mutant) -> bool:
    """Run the tests on a copy of the project in which one file is the mutant."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder)
        for name in ("damper", "tests"):
            shutil.copytree(ROOT / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(ROOT / "pyproject.toml", copy)
        (copy / "damper" / mutant.file).write_text(mutant.source)
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *TESTS]
        environment = {**os.environ, "NUMBA_DISABLE_JIT": "1", "OMP_NUM_THREADS": "1", "PYTHONPATH": folder}
        done = run(command, cwd=copy, env=environment, stdout=DEVNULL, stderr=DEVNULL, preexec_fn=_limit, check=False)
        return done.returncode != 0


def _limit() -> None:
    with contextlib.suppress(ValueError):
        resource.setrlimit(resource.RLIMIT_CPU, (PATIENCE, PATIENCE + 5))
    signal.signal(signal.SIGXCPU, signal.SIG_DFL)


if __name__ == "__main__":
    sys.exit(main())
