"""The solid blade: a volume mesh, its material, the nodes that are held, and the spin axis."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fem.linalg import Array, Ints, perpendicular
from fem.meshes.planform import MeshError
from fem.meshes.volume import VolumeMesh
from fem.plate import Material
from fem.rotor import across

ON_THE_FACE = 1e-4
"""Distance from the root's radius, relative to the mesh's extent, within which a node belongs to the root."""

FLAT = 1e-6
"""Extent of the root across its longest line, relative to that, below which it is a hinge."""


@dataclass(frozen=True, eq=False)
class Blade:
    """A solid blade on a rotor, clamped at its root.

    Attributes:
        mesh: of its volume [m].
        material: of the blade.
        root: numbers of the clamped nodes.
        axis: unit vector (3,) of the spin axis.
        origin: a point (3,) on the axis [m].

    Raises:
        MeshError: the root does not hold the blade, or holds all of it.
    """

    mesh: VolumeMesh
    material: Material
    root: Ints
    axis: Array
    origin: Array

    def __post_init__(self) -> None:
        if self.root.size == len(self.mesh.points):
            raise MeshError("the root contains every node: nothing is left to move")
        at = self.mesh.points[self.root]
        sides = np.zeros(3) if len(at) < 3 else np.linalg.svd(at - at.mean(axis=0), compute_uv=False)
        if sides[1] <= FLAT * sides[0] or sides[0] == 0.0:
            raise MeshError(
                f"the root's {self.root.size} nodes do not constrain the blade: expected three or more, not collinear"
            )
        if fault := _faceless(self.mesh, self.root):
            raise MeshError(f"the root's {fault}: expected all nodes of the clamped faces")

    @property
    def arms(self) -> Array:
        """Of the nodes from the axis, (nnode, 3) [m]."""
        return np.asarray((self.mesh.points - self.origin) @ across(self.axis))

    @cached_property
    def held(self) -> Ints:
        """Numbers of the nodes that do not move: the root's, and those of pieces inboard that it cuts off.

        Such a piece would vibrate by itself, as no part of the blade; where all lies inboard, nothing is cut off.
        """
        free = np.ones(len(self.mesh.points), dtype=bool)
        free[self.root] = False
        pieces, along = self.mesh.pieces(free), self.arms @ self.arms[self.root].mean(axis=0)
        inboard = [k for k in np.unique(pieces[free]) if along[pieces == k].mean() < along[self.root].mean()]
        inner = np.isin(pieces, inboard)
        return self.root if inner[free].all() else np.flatnonzero(~free | inner)

    @property
    def section(self) -> Array:
        """Vector area (3,) of the section at which the root holds the blade [m²].

        By Gauss' theorem that of the faces whose nodes are all held, however deep the root's nodes reach into it.
        """
        return np.asarray(self._faces.sum(axis=0))

    @cached_property
    def _faces(self) -> Array:
        """Vector areas (nface, 3) of the faces whose nodes are all held [m²]."""
        return self.mesh.boundary_normals(self.clamped)[1]

    @property
    def has_section(self) -> bool:
        """Whether those areas do not cancel but for rounding, as on both sides of a tang."""
        faces = self._faces
        return float(np.linalg.norm(faces.sum(axis=0))) > CANCELLED * float(np.linalg.norm(faces, axis=1).sum())

    @cached_property
    def clamped(self) -> NDArray[np.bool_]:
        """Which nodes do not move, (nnode,)."""
        return np.isin(np.arange(len(self.mesh.points)), self.held)

    @property
    def hung(self) -> Ints:
        """Numbers of the nodes of the cells that move, the held ones among them included."""
        free = ~self.clamped
        return np.unique(np.concatenate([nodes[free[nodes].any(axis=1)].ravel() for _, nodes in self.mesh.cells]))

    @cached_property
    def bending(self) -> tuple[Array, Array, Array, Array] | None:
        """Of that section its middle (3,) [m], unit normal (3,), second moments (3, 3) [m⁴] and nodes (m, 3) [m].

        Moments and nodes as they are seen along its normal; the nodes are those at which what is held ends. None where
        these do not lie in a plane, or nearly, compared with the section's lesser side: no linear stress is there.
        """
        if not self.has_section:
            return None
        normal = self.section / np.linalg.norm(self.section)
        area, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
        for faces in self.mesh.boundary():
            around = self.mesh.points[faces[self.clamped[faces].all(axis=1)]]
            middles = np.broadcast_to(around.mean(axis=1, keepdims=True), around.shape)
            corners = np.stack([middles, around, np.roll(around, -1, axis=1)], axis=2).reshape(-1, 3, 3)
            one, other = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
            seen, corners = 0.5 * np.cross(one, other) @ normal, perpendicular(corners, normal)
            total = corners.sum(axis=1)
            area += seen.sum()
            first += seen @ total / 3.0
            second += np.einsum("t,tki,tkj->ij", seen, corners, corners) / 12.0
            second += np.einsum("t,ti,tj->ij", seen, total, total) / 12.0
        middle = first / area
        second -= area * np.outer(middle, middle)
        ends = self.mesh.points[np.intersect1d(self.hung, self.held)]
        at, depths = perpendicular(ends, normal), ends @ normal
        sides = np.ptp((at - middle) @ np.linalg.eigh(second)[1][:, 1:], axis=0)  # the first is the normal's
        if np.ptp(depths) > LEVEL * sides.min():
            return None
        return middle + depths.mean() * normal, normal, second, at


CANCELLED = 1e-4
"""Part of the areas of held faces that their sum has where they cancel, in coordinates of five digits."""

LEVEL = 0.5
"""Depth over which what is held may end, in lesser sides of the section."""

FACING = 0.7
"""Cosine of the angle to the axis from which on a face at the inner end looks inwards."""

INNER = 0.2
"""Part of the radial extent that counts as the inner end."""


def up_to(mesh: VolumeMesh, axis: Array, origin: Array, radius: float) -> Ints:
    """Nodes up to a radius [m] from the spin axis.

    Raises:
        MeshError: there are none.
    """
    distances = np.linalg.norm(perpendicular(mesh.points - origin, axis), axis=1)
    if distances.min() > radius + ON_THE_FACE * mesh.size:
        raise MeshError(
            f"no nodes lie within {radius:.6g} m of the axis: the mesh is from {distances.min():.6g}"
            f" to {distances.max():.6g} m from it"
        )
    return np.flatnonzero(distances <= radius + ON_THE_FACE * mesh.size)


def root_at(mesh: VolumeMesh, axis: Array, origin: Array, radius: float | None = None) -> Ints:
    """Nodes of the inner end of a blade, on a cylinder about the spin axis or on a plane.

    The plane is that of the faces at the inner end that look at the axis.

    Args:
        mesh: of the blade [m].
        axis: unit vector (3,) of the spin axis.
        origin: a point (3,) on the axis [m].
        radius: of the nodes from the axis [m]; None: the least.

    Raises:
        MeshError: there are no such nodes, or they contain no whole face of a cell.
    """
    arm = perpendicular(mesh.points - origin, axis)
    middle = arm.mean(axis=0)
    if np.linalg.norm(middle) < ON_THE_FACE * mesh.size:
        raise MeshError("the mesh lies around the spin axis: name the set of nodes that is its root")
    outwards = middle / np.linalg.norm(middle)
    heights = (mesh.points - origin) @ _from_inner_end(mesh, outwards)
    distances = np.linalg.norm(arm, axis=1)
    near = ON_THE_FACE * mesh.size
    candidates = [
        np.flatnonzero(np.abs(each - (each.min() if radius is None else radius)) <= near)
        for each in (heights, distances)
    ]
    if not max(each.size for each in candidates):
        raise MeshError(
            f"no nodes lie at the radius {radius:.6g} m: the mesh is from {distances.min():.6g}"
            f" to {distances.max():.6g} m from the axis"
        )
    root = max(candidates, key=lambda each: (mesh.whole_faces(each), each.size))
    if fault := _faceless(mesh, root):
        if radius is None:
            raise MeshError(f"the innermost {fault}: name the set of nodes that is its root")
        levels = np.concatenate([mesh.level_faces(each, near) for each in (heights, distances)])
        order = np.abs(levels - radius).argsort()
        nearest = "".join(f"; the nearest with some is {1e3 * level:.7g} mm" for level in levels[order[:1]])
        raise MeshError(f"at the radius {radius:.6g} m {fault}: expected a radius with whole faces{nearest}")
    return root


def _faceless(mesh: VolumeMesh, nodes: Ints) -> str:
    """Words on nodes that contain no whole face of a cell; empty where they do."""
    if mesh.whole_faces(nodes):
        return ""
    bare = mesh.whole_faces(nodes, corners=True)
    without = f", only the corners of {bare} without their mid-side nodes" if bare else ""
    some = f"{nodes.size} nodes contain" if nodes.size != 1 else "1 node contains"
    return f"{some} no whole face of a cell{without}"


def _from_inner_end(mesh: VolumeMesh, outwards: Array) -> Array:
    """Against the mean normal of the faces at the inner end that look at the axis; outwards where there are none."""
    middles, normals = mesh.boundary_normals()
    heights = middles @ outwards
    inner = heights <= heights.min() + INNER * np.ptp(heights)
    facing = normals @ outwards < -FACING * np.linalg.norm(normals, axis=1)
    total = normals[inner & facing].sum(axis=0)
    size = float(np.linalg.norm(total))
    return outwards if size == 0.0 else np.asarray(-total / size)
