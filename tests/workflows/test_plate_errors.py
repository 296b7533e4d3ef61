"""Each error of the plate is said for what it is, and what is none of them is a defect."""

import numpy as np
import pytest
from scipy.sparse import csc_array

import fem
import workflows
from fem.linalg import factorise
from tests.workflows.conftest import MESHES, changed, on_mesh, raising, refused
from workflows import BadInput


@pytest.fixture
def quick(paper):
    """The paper's plate at one speed, as soon as it is possible."""
    return changed(paper, rotor__speeds=["5000 rpm"], release__cycles=1, accuracy__frequency=0.05)


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
def test_defects_are_defects(place, error, quick, spindamp, monkeypatch):
    """No slip of ours is blamed on the damper's place, or on the physics."""
    monkeypatch.setattr(f"fem.{place}", raising(error("what nobody thought of")))
    said = f"an internal error: {error.__name__}: what nobody thought of"
    refused(spindamp("run", quick, "--json"), "", said, status=1)


OFF = "[0.3, 0.0]: the point (0.3, 0) m does not lie on the plate"


@pytest.mark.parametrize(
    ("place", "tip_mass", "said"),
    [("30 cm", None, OFF), ("30 cm", "10 g", OFF), ("0 cm", None, "[0.0, 0.0]: expected a place that moves")],
)
@pytest.mark.parametrize("command", ["check", "run"])
def test_where_no_damper_can_be(command, place, tip_mass, said, paper, spindamp):
    """On a plate from a file, whose extent is not known before it is read.

    The damper's place is also that of the tip mass, which the search for a mesh meets first.
    """
    there = {"damper__at": [place, "0 cm"], "plate__tip_mass": tip_mass, "rotor__speeds": ["5000 rpm"]}
    scene = on_mesh(paper, MESHES / "plate_with_hole.msh", **there)
    refused(spindamp(command, scene, "--json"), "", f"scene.toml: [damper] at = {said}")


def test_no_bending_among_the_modes(quick, spindamp, monkeypatch):
    """What it lacks are modes, and no other place would help."""
    monkeypatch.setattr(fem.Campbell, "families", property(lambda diagram: [["twist"] * 6] * diagram.omega.size))
    said = refused(spindamp("run", quick, "--json"), "scene.toml: [rotor] modes = 6: no flap mode among the 6 lowest")
    assert said.endswith("request more modes\n")


@pytest.mark.parametrize(
    ("error", "says"),
    [
        (
            fem.SingularMatrix("it is so"),
            "[plate]: the plate's equations have no solution in floating point: it is so\n",
        ),
        (fem.NotConverged("it is so"), "[plate]: the plate's equations have no solution in floating point: it is so\n"),
        (fem.Divergence(100.0, -1.0), "scene.toml: [rotor] speeds: "),
        (fem.NoEquilibrium(100.0), "scene.toml: [rotor] speeds, stagger: "),
    ],
)
def test_no_answer_names_its_key(error, says, quick, spindamp, monkeypatch):
    monkeypatch.setattr("fem.campbell", raising(error))
    refused(spindamp("run", quick, "--json"), "", says, status=3)


def test_bad_input_of_a_ring_down_names_its_file(quick, spindamp, monkeypatch):
    unmoved = raising(BadInput("none of them moves: ask for more", key="[rotor] modes", value=6))
    monkeypatch.setattr("workflows.solve.coupling.release_displacement", unmoved)
    refused(spindamp("run", quick, "--json"), "scene.toml: [rotor] modes = 6: none of them moves")


def test_a_singular_matrix_is_named():
    with pytest.raises(fem.SingularMatrix, match="singular"):
        factorise(csc_array(np.diag([1.0, 0.0])))
    with pytest.raises(ValueError, match="square"):
        factorise(csc_array(np.ones((2, 3))))


def test_a_mass_that_tears_the_plate_off(paper, spindamp):
    """m Omega² R / (E b h): 1e6 kg at 3500 rpm and 0.2 m, on 8 cm² of 182.6 GPa, is a strain of 184."""
    heavy = changed(paper, rotor__speeds=["3500 rpm"], damper__housing="1e6 kg", accuracy__frequency=0.05)
    what = "1000000 kg ([plate] tip_mass, [damper] housing) pulls at 3500 rpm"
    line = refused(spindamp("run", heavy, "--json"), "", what, status=3)
    assert "would strain the root by 18000 %" in line
    assert "critical" not in line


def test_a_root_that_holds_nothing(paper, spindamp):
    springs = {"stiffness": 1e-6, "rotational_stiffness": 1e-9}
    scene = changed(paper, rotor__speeds=["0 rpm"], plate__root=springs, damper=None, release=None)
    what = "[plate.root] stiffness = 1e-06, rotational_stiffness = 1e-09: too soft"
    line = refused(spindamp("campbell", scene, "--json"), "", what, status=3)
    assert "too thin" not in line


@pytest.mark.parametrize("nothing", ["", " "])
def test_no_scene_at_all(nothing):
    with pytest.raises(
        BadInput, match=r"^expected the path of a scene, or the name of a shipped one: campbell, design, paper"
    ):
        workflows.run(nothing)
