"""Read before any test: numpy and what tests start take one thread each, for the tests have all cores already.

Rubbish is looked for less often than Python does: among all that was collected that takes time and finds little.
Bytecode is kept, whatever the environment says: each process that a test starts would compile all modules anew.
"""

import gc
import os
import sys

if "OMP_NUM_THREADS" not in os.environ:
    assert "numpy" not in sys.modules, "a plugin of pytest has imported numpy: set OMP_NUM_THREADS=1"
    os.environ["OMP_NUM_THREADS"] = "1"
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False
gc.set_threshold(100_000, 50, 100)

LONGEST = (
    "workflows/test_design.py",
    "fem/test_fem_solid.py",
    "workflows/test_response.py",
    "fem/test_fem_theories.py",
    "workflows/test_costs.py",
    "workflows/test_answer.py",
    "fem/test_fem_choice.py",
    "fem/test_fem_sweep.py",
    "fem/test_fem_perturbed.py",
    "workflows/test_sweep_survives.py",
    "workflows/test_moving_floor.py",
    "workflows/test_sweep.py",
    "workflows/test_blade.py",
    "fem/test_fem_singular.py",
    "workflows/test_ends.py",
    "workflows/test_notebook.py",
    "damper/test_reference.py",
    "survey/test_survey.py",
    "fem/test_fem_bent.py",
    "workflows/test_cli.py",
)
"""Modules that take ten seconds of a processor and more; begun first, so that no core waits for another at the end."""


def pytest_collection_modifyitems(items):
    """The longest modules first, each kept together."""
    places = {name: place for place, name in enumerate(LONGEST)}

    def place(item):
        path = item.path.as_posix()
        return next((places[name] for name in LONGEST if path.endswith(f"tests/{name}")), len(LONGEST))

    items.sort(key=place)
