"""What a scene calls for before any of it is solved: mesh, effects, theory; and why a plate has no solution."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import fem
from fem.meshes.mesh_sequence import Planform
from fem.theory.registry import solid_theory
from workflows.effects import selection
from workflows.effects.definition import Effect
from workflows.errors import NoAnswer, present
from workflows.formatting import significant, turning
from workflows.progress import Stages
from workflows.scene import plate_mesh
from workflows.scene.load import SceneFile
from workflows.scene.scene import Scene
from workflows.solve import blade
from workflows.solve.results import Theory

_BORNE = 0.1
"""Average strain of the root beyond anything that small strains describe; metals yield at a tenth of it."""


@contextmanager
def translated_errors(source: SceneFile) -> Iterator[None]:
    """Say of what has no solution why, in the words of the scene.

    Raises:
        NoAnswer: the plate diverges, has no equilibrium, or is too thin for its theory in double precision.
    """
    try:
        yield
    except fem.Divergence as error:
        why = _overloaded(source) or "all requested speeds are above the critical speed"
        raise NoAnswer(". ".join((f"{source.name}: [rotor] speeds: {error}; {why}", *source.remarks))) from error
    except fem.NoEquilibrium as error:
        key = "stagger" if source.scene.blade is None else "axis"
        raise NoAnswer(f"{source.name}: [rotor] speeds, {key}: {error}") from error
    except fem.Unresolved as error:
        if source.scene.blade is not None:
            loose = "in double precision the blade is almost free: rounding leaves no digits of its lowest frequency"
            better = "expected a root that constrains it, thicker cells, and more than a single row of cells"
            row = "hexahedra of 20 nodes in a row deform without stress"
            raise NoAnswer(f"{source.name}: [blade] root: {loose} at rest; {better}: {row}") from error
        keys = "[plate] theory, thickness"
        if (root := error.loose) is not None:
            keys = f"[plate.root] stiffness = {root.stiffness:g}, rotational_stiffness = {root.rotational:g}"
        raise NoAnswer(f"{source.name}: {keys}: {error}") from error
    except (fem.SingularMatrix, fem.NotConverged) as error:
        why = _overloaded(source) or str(error)
        body = "plate" if source.scene.blade is None else "blade"
        raise NoAnswer(
            f"{source.name}: [{body}]: the {body}'s equations have no solution in floating point: {why}"
        ) from error


def _overloaded(source: SceneFile) -> str:
    """That a point mass pulls harder than any plate bears, with its key; empty where it does not."""
    scene = source.scene
    plate, material = scene.plate, scene.material
    if plate is None or material is None or plate.length is None or scene.point_mass == 0.0:
        return ""
    fastest = max(scene.rotor.speeds)
    pull = scene.point_mass * fastest**2 * (scene.rotor.hub_radius + plate.length)
    strain = pull / (material.youngs_modulus * plate_mesh.section(plate))
    if strain < _BORNE:
        return ""
    return (
        f"the point mass of {significant(scene.point_mass)} kg ([plate] tip_mass, [damper] housing) pulls at"
        f" {turning(fastest)} such that it would strain the root by {significant(100 * strain, 2)} %,"
        " which no plate bears: expected a lighter mass or lower speeds"
    )


CELLS_PER_MODE = 5
"""Cells for each mode of a mesh on which the error of a theory is good to some ten percent of itself."""


def chosen_theory(
    scene: Scene, form: Planform | None = None, large_deflection: bool = False
) -> tuple[Theory, fem.Operators | None]:
    """The plate theory of a scene that has a plate, as given or chosen; and the matrices it was chosen by.

    `form`: the plate's planform, needed where that is a mesh.
    """
    requested = present(scene.plate).theory
    if requested != "auto":
        return Theory(requested, "requested by the scene"), None
    from fem.accuracy.theory_selection import choose_theory

    plate, rotor = plate_mesh.coarse_plate(scene, form, CELLS_PER_MODE)
    stiffened = scene.effects.stress_stiffening is not False
    effects = fem.Effects(stress_stiffening=stiffened, large_deflection=large_deflection and stiffened)
    chosen = choose_theory(plate, rotor, effects, scene.rotor.speeds, scene.rotor.modes, scene.accuracy.frequency)
    return Theory(chosen.name, chosen.why, chosen.model_error), chosen.operators


@dataclass(frozen=True, eq=False)
class ModelChoice:
    """A scene's planform and the theory of its plate, None without one; its effects; the digest of its mesh file.

    Attributes:
        model: what `fem` calls the theory, with the layers of a solid; layers: the error that these leave.
        tried: the plate's matrices by which its theory was chosen.
    """

    form: Planform | None
    effects: dict[str, Effect]
    theory: Theory | None = None
    model: str = ""
    layers: float = 0.0
    mesh_sha256: str | None = None
    tried: fem.Operators | None = None

    @property
    def plate(self) -> tuple[Planform, Theory]:
        """The planform and the theory of a scene that has a plate."""
        assert self.form is not None
        return self.form, present(self.theory)


def choose_model(source: SceneFile, stages: Stages) -> ModelChoice:
    """Read the scene's mesh, decide its effects and choose the theory of its plate.

    Raises:
        BadInput: the mesh or an effect asked for is no good.
        NoAnswer: the plate is too thin for its theory in double precision.
    """
    scene = source.scene
    if scene.plate is None:
        settled = None
        if scene.blade is not None and scene.effects.large_deflection is not True:
            with stages("prestress"), translated_errors(source):
                settled = {"large_deflection": blade.deflection(source)}
        return ModelChoice(None, selection.resolve(scene, source.name, settled=settled))
    with stages("mesh"):
        sha256, form = source.files_sha256, plate_mesh.planform(source)
    with stages("prestress"), translated_errors(source):
        effects = selection.resolve(scene, source.name, form)
        theory, tried = chosen_theory(scene, form, effects["large_deflection"].on)
        model, layers = theory.name, 0.0
        if model == "solid":
            thickest = plate_mesh.thickness_range(scene.plate, form)[2]
            model, layers = solid_theory(form.sides, thickest, scene.budget.layers)
        elif model == "mindlin" and scene.plate.root is None:
            model = "mindlin/held"  # clamped as solids are
    return ModelChoice(form, effects, theory, model, layers, sha256, tried)
