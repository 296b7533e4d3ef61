"""Read before any test: numpy and what tests start take one thread each, for the tests have all cores already."""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
