"""Volume meshes of solid blades: nodes, cells of first or second order, named sets of nodes; read from files."""

import tempfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fem.linalg import Array, Ints
from fem.meshes.cells import cell, faces_of
from fem.meshes.decks import DeckContents, deck_fault
from fem.meshes.planform import MeshError, connected, position
from fem.meshes.read import GEOMETRY, named, raw_mesh

FIRST_ORDER = ("hexahedron", "tetra", "wedge")
SECOND_ORDER = ("hexahedron20", "hexahedron27", "tetra10", "wedge15")

SAME_PLACE = 1e-7
"""Distance, relative to the mesh's extent, within which two nodes are in one place."""

SIZES = 2e-3, 20.0
"""Extents in m of what can be a blade: beyond, the unit is wrong."""


NEAR = 9
"""Faces among which one that touches a face is sought."""

FACING, LEVEL = 0.99, 1e-3
"""Cosine of the angle between faces that touch, and their distance relative to their size."""


class SizeError(MeshError):
    """A mesh whose extent is no blade's, in the unit given."""


@dataclass(frozen=True, eq=False)
class VolumeMesh:
    """A mesh of a volume in one piece, of cells of one order.

    Attributes:
        points: (npoint, 3) in m.
        cells: kinds of cells by the name that `fem.meshes.cells` has, and their points (ncell, nnode).
        sets: points by the names of sets.
        labels: numbers of the points in their file, (npoint,), each once; None: not known.
        deck: what the file holds beside.

    Raises:
        MeshError: for cells that are none of `FIRST_ORDER` and `SECOND_ORDER`, of both, inverted, overlapping, not in
            one piece or not face to face, and nodes that are not finite, missing or in one place.
    """

    points: Array
    cells: tuple[tuple[str, Ints], ...]
    sets: Mapping[str, Ints] = field(default_factory=dict)
    labels: Ints | None = None
    deck: DeckContents = field(default_factory=DeckContents)

    def __post_init__(self) -> None:
        _check_kinds([kind for kind, _ in self.cells])
        every = np.concatenate([cells.ravel() for _, cells in self.cells])
        if every.min() < 0 or every.max() >= len(self.points):
            raise MeshError("a cell refers to a node that is not in the mesh")
        if not np.isfinite(self.points).all():
            raise MeshError("some nodes have coordinates that are not finite")
        self._check_places()
        self._check_pieces()
        for kind, cells in self.cells:
            _check_volumes(kind, self.points[cells])
        self._check_faces()

    @property
    def size(self) -> float:
        """Largest extent in m."""
        return float(np.ptp(self.points, axis=0).max())

    def boundary(self) -> list[Ints]:
        """Nodes around the faces of the boundary (nface, nnode), mid-side nodes between corners."""
        return [faces[times == 1] for faces, times in self._faces]

    @cached_property
    def _faces(self) -> list[tuple[Ints, Ints]]:
        return faces_of(self.cells)

    def corners(self, faces: Ints) -> Ints:
        """The corners of faces, out of the nodes around them (nface, nnode)."""
        return faces if self.first_order else faces[:, ::2]

    def whole_faces(self, nodes: Ints, *, corners: bool = False) -> int:
        """Number of faces of cells whose nodes, or `corners` alone, are all among some nodes."""
        own = np.isin(np.arange(len(self.points)), nodes)
        every = [self.corners(faces) if corners else faces for faces, _ in self._faces]
        return sum(int(np.count_nonzero(own[faces].all(axis=1))) for faces in every)

    def level_faces(self, values: Array, within: float) -> Array:
        """Mid-range (k,) of values (npoint,) on each face of a cell over which they vary by `within` at most."""
        ends = [(values[faces].min(axis=1), values[faces].max(axis=1)) for faces, _ in self._faces]
        return np.concatenate([(0.5 * (low + high))[high - low <= within] for low, high in ends])

    def boundary_normals(self, own: NDArray[np.bool_] | None = None) -> tuple[Array, Array]:
        """Middles (nface, 3) of the corners of the boundary's faces, and the faces' vector areas (nface, 3), outwards.

        By Stokes' theorem a vector area is half the integral of r x dr around the face. Simpson's rule is exact on a
        quadratic edge: four thirds of what the polygon of all nodes has, less a third of that of the corners.

        own: which nodes (n,) all of a face's have to be; None: any.
        """
        middles, normals = [], []
        for faces in self.boundary():
            faces = faces if own is None else faces[own[faces].all(axis=1)]
            around, at = self.points[faces], self.points[self.corners(faces)]
            middles.append(at.mean(axis=1))
            normals.append((4.0 * _vector_areas(around) - _vector_areas(at)) / 3.0)
        return np.concatenate(middles), np.concatenate(normals)

    def _check_faces(self) -> None:
        from scipy.spatial import cKDTree

        shared = sum(int(np.count_nonzero(times > 2)) for _, times in self._faces)
        if shared or not sum(len(faces) for faces in self.boundary()):
            raise MeshError(f"{shared} faces belong to more than two cells: cells overlap, or are listed twice")
        middles, normals = self.boundary_normals()
        sizes = np.linalg.norm(normals, axis=1)
        units, sizes = normals / sizes[:, None], np.sqrt(sizes)
        # a face that looks at another from the same place, whose middle is nearer than their sizes: a crack
        _, near = cKDTree(middles).query(middles, k=min(NEAR, len(middles)))
        apart = middles[near] - middles[:, None]
        opposite = np.einsum("fka,fa->fk", units[near], units) < -FACING
        level = np.abs(np.einsum("fka,fa->fk", apart, units)) < LEVEL * sizes[:, None]
        inside = np.linalg.norm(apart, axis=2) < 0.5 * np.maximum(sizes[near], sizes[:, None])
        cracks = np.flatnonzero((opposite & level & inside).any(axis=1))
        if cracks.size:
            raise MeshError(
                f"{cracks.size} faces inside the blade touch others without sharing their nodes (hanging nodes), the"
                f" first near {position(middles[cracks[0]])} m: mesh so that cells meet face to face"
            )

    @property
    def first_order(self) -> bool:
        """Whether the cells have straight edges and no nodes between their corners."""
        return self.cells[0][0] in FIRST_ORDER

    def _check_places(self) -> None:
        from scipy.spatial import cKDTree

        pairs = cKDTree(self.points).query_pairs(SAME_PLACE * self.size, output_type="ndarray")
        if len(pairs):
            raise MeshError(
                f"{len(pairs)} pairs of nodes lie in one place, the first at {position(self.points[pairs[0, 0]])} m:"
                " merge them (equivalence) in the mesher"
            )

    def pieces(self, free: NDArray[np.bool_]) -> Ints:
        """Numbers (nnode,) of the pieces that cells make of the nodes that are free, (nnode,).

        -1: it is not free, or in no cell.
        """
        number, pairs = len(free), []
        for _, nodes in self.cells:  # a cell joins its free nodes
            own = np.broadcast_to(number + np.arange(len(nodes))[:, None], nodes.shape)
            pairs.append(np.stack([own[free[nodes]], nodes[free[nodes]]]))
            number += len(nodes)
        every = np.concatenate(pairs, axis=1)
        joined, found = np.unique(every[1]), np.full(len(free), -1)
        found[joined] = np.unique(connected(every, number)[1][joined], return_inverse=True)[1]
        return found

    def _check_pieces(self) -> None:
        label = self.pieces(np.ones(len(self.points), dtype=bool))
        loose = int(np.count_nonzero(label < 0))
        if loose:
            raise MeshError(f"{loose} nodes belong to no cell")
        sizes = np.sort(np.bincount(label))[::-1]
        if sizes.size > 1:
            raise MeshError(
                f"the mesh is in {sizes.size} pieces, of {', '.join(map(str, sizes[:4]))} nodes"
                f"{' ...' * bool(sizes.size > 4)}: a blade is one piece; merge their nodes or remove the others"
            )


def _vector_areas(rings: Array) -> Array:
    """Vector areas (nface, 3) of closed polygons (nface, nnode, 3)."""
    arms = rings - rings[:, :1]
    return np.asarray(0.5 * np.cross(arms, np.roll(arms, -1, axis=1)).sum(axis=1))


def _check_kinds(kinds: list[str]) -> None:
    if not kinds:
        raise MeshError("the mesh holds no cells with a volume")
    strange = sorted(set(kinds) - {*FIRST_ORDER, *SECOND_ORDER})
    if strange:
        raise MeshError(f"cells of kind {', '.join(strange)} are not supported: use tetrahedra, hexahedra or wedges")
    if set(kinds) & set(FIRST_ORDER) and set(kinds) & set(SECOND_ORDER):
        raise MeshError(
            f"cells of first and second order are mixed ({', '.join(sorted(set(kinds)))}): mesh with one order"
        )


def _check_volumes(kind: str, corners: Array) -> None:
    """Cells with nodes (ncell, nnode, 3) that are turned inside out, flat, or whose corners are listed out of order.

    The mapping of the cell at places where it is integrated, and at its corners that of the straight cell between them.
    """
    straight = next(name for name in FIRST_ORDER if kind.startswith(name))
    ends = cell(straight).nodes
    sizes = cell(straight).sizes(corners[:, : len(ends)], ends)
    bad = (sizes < -FLAT * np.abs(sizes).max(axis=1, keepdims=True)).any(axis=1)
    bad |= ~(cell(kind).sizes(corners, _inside(kind)) > 0.0).all(axis=1)
    bad |= _folded(kind, corners, len(ends))
    if bad.any():
        first = int(np.flatnonzero(bad)[0])
        raise MeshError(
            f"{np.count_nonzero(bad)} of {len(corners)} {kind} cells are inverted, flat or too distorted, or list their"
            f" corners out of order, the first (number {first + 1} of these in the file) near"
            f" {position(corners[first].mean(axis=0))} m"
        )


def _folded(kind: str, nodes: Array, corners: int) -> NDArray[np.bool_]:
    """Cells (ncell,) with a node between corners that is not there, or with one face turned against the others.

    Around a face that is turned all are twisted; half of those with four corners count, where a distorted cell may have
    two of six.
    """
    folded, twisted = np.zeros(len(nodes), dtype=bool), np.zeros(len(nodes), dtype=np.int64)
    for ring in cell(kind).faces:
        middles = [number for number in ring if number >= corners]
        at = nodes[:, [number for number in ring if number < corners]]
        ahead = np.roll(at, -1, axis=1) - at
        if middles:
            off = np.linalg.norm(nodes[:, middles] - at - 0.5 * ahead, axis=2)
            folded |= (off > BULGE * np.linalg.norm(ahead, axis=2)).any(axis=1)
        normals = np.cross(np.roll(ahead, 1, axis=1), ahead)
        sizes = np.linalg.norm(normals, axis=2)
        sharp = sizes > SLIVER * sizes.max(axis=1, keepdims=True)
        along = np.einsum("cka,cla->ckl", normals, normals) < WARP * sizes[:, :, None] * sizes[:, None, :]
        twisted += (along & sharp[:, :, None] & sharp[:, None, :]).any(axis=(1, 2))
    quads = sum(len(ring) % 4 == 0 for ring in cell(kind).faces)
    return folded | ((twisted > 0) & (2 * twisted + 1 >= quads))


BULGE = 0.6
"""Distance of a node from the middle between two corners, relative to theirs, beyond which it is that of another edge;
in a half circle it is 0.5."""

WARP, SLIVER = 0.0, 0.1
"""Cosine of the angle between the normals at two corners of a face below which the face is twisted; and the area at a
corner, relative to the face's largest, from which it has a normal."""

FLAT = 1e-6
"""Volume at a corner relative to the largest of its cell, negative, up to which the corner counts as flat."""


def _inside(kind: str) -> Array:
    """Reference places (p, 3) half-way from the middle of a cell to its nodes, about where it is integrated."""
    nodes = cell(kind).nodes
    middle = nodes.mean(axis=0)
    return np.asarray(np.vstack([middle, middle + 0.57 * (nodes - middle)]))


def read_volume(path: str | Path, scale: float = 1.0, size: float | None = None) -> VolumeMesh:
    """Read a volume mesh, or mesh geometry with tetrahedra of second order by Gmsh.

    Cells of surfaces and lines are passed over, but name sets; nodes of no volume are left out.

    Args:
        path: of the file.
        scale: m to the unit of the file's coordinates; geometry has its own.
        size: of the cells of geometry [m].

    Raises:
        MeshError: with the file's name, for a file that cannot be read, or a mesh that no blade can be made of.
    """
    path = Path(path)
    with named(path):
        if path.suffix.lower() in GEOMETRY:
            return volume_of(path, _meshed(path, scale, size), 1.0)
        if size is not None:
            raise MeshError(f"a mesh has its own cell size: size belongs to geometry ({', '.join(GEOMETRY)})")
        return volume_of(path, raw_mesh(path), scale)


def _meshed(path: Path, scale: float, size: float | None) -> Any:
    """What a reader gives of geometry that Gmsh has meshed, in m."""
    if size is None:
        raise MeshError("this is geometry without a mesh: give the size of its cells, or a mesh of its volume")
    if scale != 1.0:
        raise MeshError("geometry files state their unit: leave out `unit`")
    try:
        import gmsh
    except (ImportError, OSError) as error:  # its libraries of the system are missing
        raise MeshError(
            f"to mesh geometry, the package gmsh must be installed (pip install spindamp[step]): {error}"
        ) from None
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setString("Geometry.OCCTargetUnit", "M")
        gmsh.model.occ.importShapes(str(path))
        gmsh.model.occ.synchronize()
        for name in ("Min", "Max"):
            gmsh.option.setNumber(f"Mesh.MeshSize{name}", size)
        gmsh.option.setNumber("Mesh.ElementOrder", 2)
        gmsh.option.setNumber("Mesh.HighOrderOptimize", 1)
        gmsh.model.mesh.generate(3)
        with tempfile.TemporaryDirectory() as folder:
            gmsh.write(str(Path(folder) / "volume.msh"))
            raw = raw_mesh(Path(folder) / "volume.msh")
        raw.deck.labels.clear()  # which nobody has seen
        return raw
    except MeshError:
        raise
    except Exception as error:  # gmsh raises plain ones
        raise MeshError(f"Gmsh cannot mesh this geometry: {' '.join(str(error).split())}") from None
    finally:
        gmsh.finalize()


def volume_of(path: Path, raw: Any, scale: float) -> VolumeMesh:
    """The mesh of what `raw_mesh` gives of a file, in m; see `read_volume`."""
    solid = [block for block in raw.cells if block.dim == 3]
    kinds = sorted({block.type for block in solid})
    _check_kinds(kinds)
    points = scale * np.asarray(raw.points, dtype=float)
    if points.ndim != 2 or points.shape[1] != 3:
        raise MeshError(deck_fault(path) or "its nodes do not have three coordinates")
    cells = [
        (kind, np.vstack([block.data for block in solid if block.type == kind]).astype(np.int64)) for kind in kinds
    ]
    for kind, nodes in cells:
        if nodes.shape[1] != len(cell(kind).nodes):
            raise MeshError(f"it gives {kind} cells {nodes.shape[1]} nodes: some of their lines are not read")
    used = np.unique(np.concatenate([nodes.ravel() for _, nodes in cells]))
    if used[0] < 0 or used[-1] >= len(points):
        raise MeshError("a cell refers to a node that is not in the file")
    number = np.full(len(points), -1)
    number[used] = np.arange(used.size)
    points = points[used]
    own = np.array(raw.deck.labels, dtype=np.int64)
    labels = own[used] if len(own) == len(number) else used + 1
    odd = labels[~np.isfinite(points).all(axis=1)]
    if odd.size:
        many = "1 node has" if odd.size == 1 else f"{odd.size} nodes have"
        raise MeshError(
            deck_fault(path) or f"{many} coordinates that are not finite, the first is number {odd[0]} in the file"
        )
    extent = float(np.ptp(points, axis=0).max())
    if not SIZES[0] <= extent <= SIZES[1]:
        given = "" if scale == 1.0 else " in the unit given"
        fits = [name for name, unit in (("m", 1.0), ("mm", 1e-3)) if SIZES[0] <= extent / scale * unit <= SIZES[1]]
        question = f"are its coordinates in {' or '.join(fits)}?" if fits else "expected 2 mm to 20 m"
        raise SizeError(f"the mesh measures {extent:.3g} m{given}: {question}")
    renumbered = [(kind, _upright(kind, number[nodes], points)) for kind, nodes in cells]
    sets = {}
    for name, nodes in _sets(raw).items():
        nodes_kept = number[nodes[(nodes >= 0) & (nodes < len(number))]]
        if (nodes_kept >= 0).any():
            sets[name] = np.unique(nodes_kept[nodes_kept >= 0])
    try:
        known = len(own) == len(number) and np.unique(labels).size == labels.size
        return VolumeMesh(points, tuple(renumbered), sets, labels if known else None, raw.deck)
    except MeshError as error:  # a node that is listed twice, say, is where it was listed last
        raise MeshError("; ".join(filter(None, (str(error), deck_fault(path))))) from None


def has_volume(raw: Any) -> bool:
    """Whether what `raw_mesh` gives of a file has cells with a volume."""
    return any(block.dim == 3 for block in raw.cells)


def _upright(kind: str, cells: Ints, points: Array) -> Ints:
    """Cells that are all listed as mirror images, as some writers do with wedges, the right way round."""
    if (cell(kind).sizes(points[cells], _inside(kind)) > 0.0).any():
        return cells
    nodes = cell(kind).nodes
    image = nodes[:, [1, 0, 2]] if kind.startswith("tetra") else nodes * [1.0, 1.0, -1.0]
    order = np.abs(nodes[None] - image[:, None]).sum(axis=2).argmin(axis=1)
    return cells[:, order]


def _sets(raw: Any) -> dict[str, Ints]:
    """Points of named sets: of points, and of cells, Gmsh's physical groups among them."""
    sets = {str(name): np.asarray(points, dtype=np.int64).ravel() for name, points in raw.point_sets.items()}
    for name, parts in raw.cell_sets.items():
        if str(name).startswith("gmsh:"):  # entities, not cells
            continue
        named = zip(raw.cells, parts, strict=False)
        nodes = [block.data[np.asarray(part, np.int64)] for block, part in named if part is not None and len(part)]
        if nodes:
            sets.setdefault(str(name), _each_once(nodes))
    tags = raw.cell_data.get("gmsh:physical")
    for name, (tag, dimension, *_) in raw.field_data.items() if tags is not None else ():
        tagged = zip(raw.cells, tags, strict=False)
        nodes = [block.data[np.asarray(own) == tag] for block, own in tagged if block.dim == dimension]
        if nodes:
            sets.setdefault(str(name), _each_once(nodes))
    return sets


def _each_once(nodes: list[Any]) -> Ints:
    return np.unique(np.concatenate([each.ravel() for each in nodes])).astype(np.int64)
