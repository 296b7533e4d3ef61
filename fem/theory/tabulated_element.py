"""Elements whose shape functions are combinations of monomials in each cell, all tabulated at once.

scikit-fem's `ElementGlobal` evaluates every monomial anew for every function, which is most of an assembly's time, and
compares the normals of all edges on the boundary with one another, which on cells that share no edges are all edges.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

PIECE = 256
"""Cells whose combinations are found at once."""


def together(kind: Any) -> Any:
    """Make an element of a scikit-fem class derived from `ElementGlobal`, its functions computed together.

    It is for meshes whose cells share no points.
    """
    from skfem.element import DiscreteField

    class Together(kind):  # type: ignore[misc]
        _places: tuple[Any, ...] = ()
        _functions: tuple[Any, ...] = ()

        def gbasis(self, mapping: Any, X: Any, i: int, tind: Any = None) -> tuple[Any]:
            places = (mapping, X, tind)
            if len(self._places) != 3 or any(a is not b for a, b in zip(places, self._places, strict=True)):
                self._functions = self._tabulate(mapping, X, tind)
                self._places = places
            return (self._functions[i],)

        def _eval_dofs(self, mesh: Any, tind: Any = None) -> Any:
            cells = np.arange(mesh.t.shape[1]) if tind is None else np.asarray(tind)
            pieces = np.split(cells, range(PIECE, cells.size, PIECE))
            return np.concatenate([super(Together, self)._eval_dofs(mesh.restrict(piece)) for piece in pieces])

        def _tabulate(self, mapping: Any, X: Any, tind: Any) -> tuple[Any, ...]:
            if self.V is None:
                super().gbasis(mapping, X[:, :1], 0, np.zeros(1, dtype=int))  # finds the combinations V of every cell
            combinations = np.swapaxes(self.V if tind is None else self.V[tind], 1, 2)
            at = mapping.F(X, tind=tind)
            tables = []
            for order in range(self.derivatives + 1):
                found = {}
                for along in product(range(self.dim), repeat=order):
                    monomials = np.stack([monomial(*at) for monomial in self._pbasis[along]], axis=1)
                    found[along] = combinations @ monomials
                table = np.stack(list(found.values())).reshape((self.dim,) * order + found[along].shape)
                tables.append(np.moveaxis(table, -2, 0))
            return tuple(DiscreteField(value=u, grad=du, hess=ddu) for u, du, ddu in zip(*tables, strict=True))

    return Together()
