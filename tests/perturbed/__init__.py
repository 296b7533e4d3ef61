"""The plate's iterative solvers on problems that differ by rounding alone: their answers may not.

    python -m tests.perturbed [--times 100] [--seed 0] [--only NAME]

Every hard case of `cases` is solved again with its numbers changed in their last bits, its unknowns numbered in
another order, its units rescaled, and the solvers' start vectors drawn anew. Each answer must agree with the one
unchanged, within what rounding leaves uncertain of it; none may fail where another does not.
"""
