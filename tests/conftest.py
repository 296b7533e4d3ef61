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
    "design response sweep_survives fem_solid costs fem_choice answer fem_theories moving_floor working "
    "sweep fem_perturbed blade report trust notebook fem_sweep"
)
"""Modules that take ten seconds of a processor and more; begun first, so that no core waits for another at the end."""


def pytest_collection_modifyitems(items):
    """The longest modules first, each kept together."""
    places = {name: place for place, name in enumerate(LONGEST.split())}

    def place(item):
        return places.get(item.path.stem.removeprefix("test_"), len(LONGEST))

    items.sort(key=place)
