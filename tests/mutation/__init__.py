"""Does a fault in `damper` make a test fail? Mutants of its source, and the tests that ought to notice them.

    python -m tests.mutation [--sample N] [--seed S] [--jobs J] [--out FILE]

Kernels run as plain Python: compiling every mutant would take a minute each. General tools leave functions with a
decorator alone, and here every kernel has one.
"""
