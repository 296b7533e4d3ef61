"""Each error of the plate is said for what it is, and what is none of them is a defect."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import workflows
from tests.workflows.conftest import Command, Scene, changed, refused, write
from workflows import BadInput

MESHES = Path(__file__).parents[2] / "meshes"


@pytest.fixture
def quick(paper: Scene, tmp_path: Path) -> Path:
    """The paper's plate at one speed, as soon as it is possible."""
    soon = {"rotor__speeds": ["5000 rpm"], "release__cycles": 1, "accuracy__frequency": 0.05}
    return write(changed(paper, **soon), tmp_path / "scene.toml")


@pytest.mark.parametrize(
    ("place", "error"),
    [
        ("choose_mesh", ValueError),
        ("choose_mesh", FloatingPointError),
        ("campbell", RuntimeError),
        ("campbell", np.linalg.LinAlgError),
        ("Reduction", ArithmeticError),
    ],
)
def test_defects_are_defects(
    place: str, error: type[Exception], quick: Path, spindamp: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No slip of ours is blamed on the damper's place, or on the physics."""

    def slip(*_: object, **__: object) -> None:
        raise error("what nobody thought of")

    monkeypatch.setattr(f"fem.{place}", slip)
    refused(
        spindamp("run", quick, "--json"), "", f"an internal error: {error.__name__}: what nobody thought of", status=1
    )


def _on_the_mesh(scene: Scene, path: Path, **changes: object) -> Path:
    """The scene on a plate from a file, whose extent is not known before it is read."""
    shutil.copy(MESHES / "plate_with_hole.msh", path)
    mesh = {"plate__length": None, "plate__width": None, "plate__mesh": "plate_with_hole.msh"}
    return write(changed(scene, rotor__speeds=["5000 rpm"], **mesh, **changes), path / "scene.toml")


OFF = "[0.3, 0.0]: the point (0.3, 0) m does not lie on the plate"


@pytest.mark.parametrize(
    ("place", "tip_mass", "said"),
    [("30 cm", None, OFF), ("30 cm", "10 g", OFF), ("0 cm", None, "[0.0, 0.0]: expected a place that moves")],
)
@pytest.mark.parametrize("command", ["check", "run"])
def test_where_no_damper_can_be(
    command: str, place: str, tip_mass: str | None, said: str, paper: Scene, spindamp: Command, tmp_path: Path
) -> None:
    """The damper's place is also that of the tip mass, which the search for a mesh meets first."""
    _on_the_mesh(paper, tmp_path, damper__at=[place, "0 cm"], plate__tip_mass=tip_mass)
    refused(spindamp(command, "scene.toml", "--json"), "", f"scene.toml: [damper] at = {said}")


def test_no_bending_among_the_modes(quick: Path, spindamp: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    """What it lacks are modes, and no other place would help."""
    from fem import Campbell

    monkeypatch.setattr(Campbell, "families", property(lambda diagram: [["twist"] * 6] * diagram.omega.size))
    outcome = spindamp("run", quick, "--json")
    assert outcome.status == 2
    assert "scene.toml: [rotor] modes = 6: no flap mode among the 6 lowest" in outcome.err
    assert outcome.err.endswith("request more modes\n")


@pytest.mark.parametrize("kind", ["SingularMatrix", "NotConverged"])
def test_no_answer_in_floating_point(
    kind: str, quick: Path, spindamp: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fem

    def lost(*_: object, **__: object) -> None:
        raise getattr(fem, kind)("it is so")

    monkeypatch.setattr("fem.campbell", lost)
    outcome = spindamp("run", quick, "--json")
    assert outcome.status == 3
    assert outcome.err.endswith("[plate]: the plate's equations have no solution in floating point: it is so\n")


@pytest.mark.parametrize(
    ("kind", "found", "keys"),
    [("Divergence", (100.0, -1.0), "[rotor] speeds"), ("NoEquilibrium", (100.0,), "[rotor] speeds, stagger")],
)
def test_no_answer_at_a_speed_names_its_key(
    kind: str, found: tuple[float, ...], keys: str, quick: Path, spindamp: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    import fem

    def lost(*_: object, **__: object) -> None:
        raise getattr(fem, kind)(*found)

    monkeypatch.setattr("fem.campbell", lost)
    refused(spindamp("run", quick, "--json"), "", f"{quick.name}: {keys}: ", status=3)


def test_bad_input_of_a_ring_down_names_its_file(
    quick: Path, spindamp: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    def unmoved(*_: object) -> None:
        raise BadInput("none of them moves: ask for more", key="[rotor] modes", value=6)

    monkeypatch.setattr("workflows.solve.coupling.release_displacement", unmoved)
    refused(spindamp("run", quick, "--json"), "", f"{quick.name}: [rotor] modes = 6: none of them moves")


def test_a_singular_matrix_is_named() -> None:
    from scipy.sparse import csc_array

    from fem import SingularMatrix
    from fem.linalg import factorise

    with pytest.raises(SingularMatrix, match="singular"):
        factorise(csc_array(np.diag([1.0, 0.0])))
    with pytest.raises(ValueError, match="square"):
        factorise(csc_array(np.ones((2, 3))))


def test_a_mass_that_tears_the_plate_off(paper: Scene, spindamp: Command, tmp_path: Path) -> None:
    """m Omega² R / (E b h): 1e6 kg at 3500 rpm and 0.2 m, on 8 cm² of 182.6 GPa, is a strain of 184."""
    heavy = changed(paper, rotor__speeds=["3500 rpm"], damper__housing="1e6 kg", accuracy__frequency=0.05)
    write(heavy, tmp_path / "scene.toml")
    outcome = spindamp("run", "scene.toml", "--json")
    assert outcome.status == 3
    (line,) = outcome.err.splitlines()
    assert "1000000 kg ([plate] tip_mass, [damper] housing) pulls at 3500 rpm" in line
    assert "would strain the root by 18000 %" in line
    assert "critical" not in line


def test_a_root_that_holds_nothing(paper: Scene, spindamp: Command, tmp_path: Path) -> None:
    springs = {"stiffness": 1e-6, "rotational_stiffness": 1e-9}
    scene = changed(paper, rotor__speeds=["0 rpm"], plate__root=springs, damper=None, release=None)
    write(scene, tmp_path / "scene.toml")
    outcome = spindamp("campbell", "scene.toml", "--json")
    assert outcome.status == 3
    (line,) = outcome.err.splitlines()
    assert "[plate.root] stiffness = 1e-06, rotational_stiffness = 1e-09: too soft" in line
    assert "too thin" not in line


@pytest.mark.parametrize("nothing", ["", " "])
def test_no_scene_at_all(nothing: str) -> None:
    with pytest.raises(
        BadInput, match=r"^expected the path of a scene, or the name of a shipped one: campbell, design, paper"
    ):
        workflows.run(nothing)
