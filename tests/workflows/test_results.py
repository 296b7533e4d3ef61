"""The files of a run: each readable by whoever will read it, and all of one mind."""

import csv
import hashlib
import json
import math
import os
import re
import shutil
import sys
from collections import Counter
from dataclasses import dataclass, fields, replace
from pathlib import Path

import h5netcdf
import jsonschema
import meshio
import numpy as np
import pytest
import xarray as xr

import spindamp
import workflows
from tests.workflows.conftest import MESHES, changed, python, stored
from tests.workflows.test_resources import MEASURED
from workflows.effects import selection
from workflows.io import provenance, serialise
from workflows.io.folder import MANIFEST
from workflows.scene import quantities
from workflows.scene.load import load, parse
from workflows.solve.results import OTHER_WAYS, Results, SpeedPoint
from workflows.studies.sweep.evaluate import QUANTITIES

pytestmark = pytest.mark.usefixtures("undrawn")

SCHEMA = stored(Path(workflows.__file__).with_name("results.schema.json"))
STAGES = {"mesh", "prestress", "modes", "reduction", "damper", "write", "report", "total"}
TABLE_II = [208.9, 218.8, 241.3, 269.5, 301.7, 336.7, 373.5]


def test_document_meets_its_schema(document):
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    jsonschema.validate(document, SCHEMA)


def test_every_stage_is_timed(document):
    timings = document["timings"]
    assert set(timings) == STAGES
    parts = sum(seconds for name, seconds in timings.items() if name != "total")
    assert 0 < parts <= timings["total"]


def test_frequencies_and_loads_of_table_two(document):
    points = document["speeds"]
    assert [round(point["load_g"]) for point in points] == [2687, 5483, 12337, 21932, 34269, 49348, 67168]
    assert [point["rpm"] for point in points] == [3500, 5000, 7500, 10000, 12500, 15000, 17500]
    first = [point["modes"][0]["frequency_hz"] for point in points]
    np.testing.assert_allclose(first, TABLE_II, rtol=1e-3)
    for point in points:
        assert point["modes"][0]["family"] == "flap"
        assert point["modes"][0]["error_parts"]["mesh"] <= 1e-3
        for mode in point["modes"]:
            parts = [part for part in mode["error_parts"].values() if part is not None]
            assert mode["error_estimate"] == pytest.approx(sum(parts))
            assert mode["error_parts"]["coriolis"] is None  # it is on
        frequencies = [mode["frequency_hz"] for mode in point["modes"]]
        assert frequencies == sorted(frequencies)
        cutoff = point["damper"]["cutoff_ratio"]
        assert cutoff == pytest.approx(point["damper"]["cutoff_g"] / point["load_g"])
        assert 0.09 <= cutoff <= 0.112 or point["load_g"] < 12337


def test_reduced_parameters_belong_together(document):
    for point in document["speeds"]:
        reduced = point["reduced"]
        for number in "12":
            stiffness = reduced[f"M{number}"] * (2 * np.pi * reduced[f"f{number}_hz"]) ** 2
            assert reduced[f"K{number}"] == pytest.approx(stiffness)
        assert reduced["M1"] == pytest.approx(1.006 * reduced["M2"])
        # Coriolis forces, which the reduced parameters leave out, move the first bending mode by some 1e-6 here.
        assert reduced["f1_hz"] < reduced["f2_hz"] == pytest.approx(point["modes"][0]["frequency_hz"], rel=1e-5)


def test_the_dampers_own_figures(document):
    """Peaks of the ball's share of a cycle's energy and cut-off ratios, from direct integration with ζ = 0.001 and, in
    the equations of motion, the tilt of the floor; a cycle's decay resolves the cut-offs there."""
    level = [0.00427, 0.00265, 0.00160, 0.00119, 0.00098, 0.00086, 0.00079]
    tilting = [0.00339, 0.00169, 0.00064, 0.00027, 0.000125, 0.000061, 0.000032]
    ratios = [0.113, 0.126, 0.159, 0.210, 0.281, 0.377, 0.504]
    for point, flat, tilted, ratio in zip(document["speeds"], level, tilting, ratios, strict=True):
        working, omega = point["working"], 2 * np.pi * point["reduced"]["f1_hz"]
        share = [-np.expm1(-4 * np.pi * one["damping_ratio_peak"]) for one in (working["level_floor"], working)]
        np.testing.assert_allclose(share, [flat, tilted], rtol=0.03)
        assert working["cutoff"] < working["range"][0] < working["at_amplitude"] < working["range"][1]
        assert working["range"] == working["half_range"]
        along = working.get("driven_from", working["cutoff"])
        assert along * omega**2 / (10 * point["load_g"]) == pytest.approx(ratio, rel=0.015)
        assert working["level_floor"]["cutoff"] * omega**2 / (10 * point["load_g"]) == pytest.approx(0.1)
        slope = working["floor_tilt_share"] * omega**2 / (10 * point["load_g"])
        assert point["reduced"]["floor_tilt"] == pytest.approx(slope)
        assert working["error"] < 0.1


def test_cycles_are_the_papers_quantities(document):
    for point in document["speeds"]:
        damper, omega = point["damper"], 2 * np.pi * point["reduced"]["f1_hz"]
        velocity = np.array([cycle["peak_velocity"] for cycle in damper["cycles"]])
        amplitude = np.array([cycle["amplitude_g"] for cycle in damper["cycles"]])
        sdc = np.array([cycle["sdc"] for cycle in damper["cycles"]])
        np.testing.assert_allclose(amplitude, velocity * omega / 10, rtol=1e-12)
        np.testing.assert_allclose(sdc[:-1], 1 - (velocity[1:] / velocity[:-1]) ** 2, atol=1e-12)
        best = int(np.argmax(sdc))
        assert (damper["peak_sdc"], damper["peak_sdc_at_g"]) == (sdc[best], amplitude[best])
        assert damper["intrinsic_sdc"] == pytest.approx(sdc[-1], rel=1e-9)


def test_netcdf_is_the_data_set(finished):
    """As xarray itself writes it: same names, dimensions, types, attributes, missing numbers."""
    read = xr.load_dataset(finished / "results.nc", engine="h5netcdf")
    assert read.identical(workflows.dataset(workflows.load_results(finished)))
    assert all(math.isnan(each.encoding["_FillValue"]) for each in read.values() if each.dtype.kind == "f")


def test_netcdf_is_labelled_and_agrees(finished, document):
    with xr.open_dataset(finished / "results.nc", engine="h5netcdf") as data:
        assert set(data.dims) == {"rpm", "mode", "cycle", "point"}
        assert data.rpm.attrs["units"] == "rpm"
        for variable in data.data_vars.values():
            assert variable.attrs.get("units") or variable.dtype.kind in "OUT"
        at = data.sel(rpm=10000)
        point = document["speeds"][3]
        assert float(at.frequency_hz[0]) == point["modes"][0]["frequency_hz"]
        assert str(at.family.values[0]) == "flap"
        assert float(at.M2) == point["reduced"]["M2"]
        sdc = at.sdc.dropna("cycle").values
        assert list(sdc) == [cycle["sdc"] for cycle in point["damper"]["cycles"]]
        assert float(at.damping_ratio_peak) == point["working"]["damping_ratio_peak"]
        assert [float(at.range_low), float(at.range_high)] == point["working"]["range"]
        assert float(at.energy_impact) == point["damper"]["energy"]["impact"]


def test_a_csv_for_every_curve(finished, document):
    names = {path.stem for path in finished.glob("*.csv")}
    assert {f"sdc_{point['rpm']:.0f}rpm" for point in document["speeds"]} <= names
    assert {f"damping_ratio_{point['rpm']:.0f}rpm" for point in document["speeds"]} <= names
    assert {"campbell_flap_1", "velocity_x_10000rpm", "velocity_y_10000rpm"} <= names
    for path in set(finished.glob("*.csv")) - {finished / "speeds.csv"}:
        assert len(path.read_text().splitlines()[0].split(",")) == 2
        assert np.isfinite(np.loadtxt(path, delimiter=",", skiprows=1)).all()
    flap = np.loadtxt(finished / "campbell_flap_1.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(flap[:, 1], [p["modes"][0]["frequency_hz"] for p in document["speeds"]], rtol=1e-9)


def test_a_table_for_spreadsheets_has_a_row_a_speed(finished, document):
    with (finished / "speeds.csv").open(newline="", encoding="utf-8") as text:
        rows = list(csv.DictReader(text))
    for row, point in zip(rows, document["speeds"], strict=True):
        assert float(row["rpm"]) == point["rpm"]
        assert float(row["frequency_hz [Hz] 2"]) == point["modes"][1]["frequency_hz"]
        assert row["family 2"] == point["modes"][1]["family"]
        assert float(row["M2 [kg]"]) == point["reduced"]["M2"]
        assert float(row["damping_ratio_peak"]) == point["working"]["damping_ratio_peak"]
        assert row["verdict_grade"] == point["verdict"]["grade"]
    assert not any("nan" in cell for row in rows for cell in row.values())


def test_vtu_has_every_mode(finished, document):
    mesh = meshio.read(finished / "modes.vtu")
    numbered = [(point["rpm"], k + 1) for point in document["speeds"] for k in range(len(point["modes"]))]
    assert set(mesh.point_data) == {f"mode_{number}_at_{rpm:g}_rpm" for rpm, number in numbered}
    for name, field in mesh.point_data.items():
        assert field.shape == (len(mesh.points), 3), name
        assert np.linalg.norm(field, axis=1).max() == pytest.approx(1)
    first = mesh.point_data["mode_1_at_10000_rpm"]
    np.testing.assert_allclose(first[mesh.points[:, 0] == 0], 0, atol=1e-12)


@pytest.mark.usefixtures("quickly")
def test_nothing_spins(paper):
    results = workflows.run(changed(paper, rotor__speeds=[0], release__cycles=5))
    point = workflows.document(results)["speeds"][0]
    assert point["load_g"] == 0
    assert point["damper"]["cutoff_ratio"] is None
    jsonschema.validate(workflows.document(results), SCHEMA)


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize(("stagger", "said"), [("0 deg", False), ("90 deg", True)])
def test_coriolis_forces_that_the_damper_does_not_feel(paper, stagger, said):
    """Bending in the plane of rotation is lowered by 0.4 % at 17500 rpm, bending across it not at all."""
    scene = changed(paper, rotor__speeds=["17500 rpm"], rotor__stagger=stagger, release__cycles=2)
    assert ("is that of the real mode" in " ".join(workflows.run(scene).notes)) is said


def test_what_comes_back_is_what_was_written(finished, document, tmp_path):
    """Every number of results.json, its picture of the mode, and the page made anew."""
    back = spindamp.load_results(finished)
    again = json.loads(json.dumps(workflows.document(back)))
    assert again == document
    assert repr(back).startswith("The paper's plate")
    page = spindamp.report(back, tmp_path / "again.html").read_text(encoding="utf-8")
    theirs = (finished / "report.html").read_text(encoding="utf-8")
    verdict = theirs.partition('class="verdict">')[2].partition("<")[0]
    assert verdict
    assert verdict in page
    assert "data:image/png" in page


@pytest.mark.usefixtures("quickly")
def test_names_and_varying_thickness_survive(paper, tmp_path):
    named = {"material": {"name": "Ti-6Al-4V"}, "damper__ball_material": "tungsten carbide", "damper__mass_ratio": None}
    tapered = {"plate__thickness": {"x": [0, 0.2], "values": [[0.01], [0.008]]}}
    few = {"rotor__speeds": ["5000 rpm"], "rotor__modes": 2, "effects": None}
    found = spindamp.run(changed(paper, **named, **tapered, **few))
    spindamp.save(found, tmp_path / "out")
    back = spindamp.load_results(tmp_path / "out")
    assert back.scene == found.scene
    assert back.effects == found.effects
    assert back.speeds[0].cavity_modes == found.speeds[0].cavity_modes
    np.testing.assert_array_equal(back.surface.shapes, found.surface.shapes)
    np.testing.assert_array_equal(back.surface.thickness, found.surface.thickness)


WORN = (None, b"", b"[]", b"[" * 100_000, b'{"schema_version": 1}', b'{"schema_version": 99}')


@pytest.mark.parametrize(
    ("name", "content"),
    [*(("results.json", each) for each in WORN), *(("results.nc", each) for each in (None, b"", b"no HDF5"))],
)
def test_what_is_no_run_says_so(finished, name, content, tmp_path):
    for each in ("results.json", "results.nc"):
        shutil.copy(finished / each, tmp_path / each)
    if content is None:
        (tmp_path / name).unlink()
    else:
        (tmp_path / name).write_bytes(content)
    with pytest.raises(workflows.BadInput, match=r"folder = [^\n]*(no run|is damaged|version 99)[^\n]*$"):
        spindamp.load_results(tmp_path)
    with pytest.raises(TypeError):
        spindamp.load_results(3)


def test_a_pipe_is_not_waited_for(finished, tmp_path):
    name = "results.nc"
    shutil.copy(finished / "results.json", tmp_path)
    os.mkfifo(tmp_path / name)
    done = python("-c", f"import spindamp; spindamp.load_results({str(tmp_path)!r})")
    assert f"expected a file {name}, found a pipe: run it again" in done.stderr.splitlines()[-1]


def test_rubbish_within_hdf5_is_one_line(finished, tmp_path):
    """A byte in a thousand turned over, so that what lists the groups is wrong, or what they hold."""
    shutil.copy(finished / "results.json", tmp_path)
    content = bytearray((finished / "results.nc").read_bytes())
    for place in range(200, len(content), 997):
        content[place] ^= 0xFF
    (tmp_path / "results.nc").write_bytes(content)
    done = python("-m", "workflows.cli", "view", tmp_path, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert len(done.stderr.splitlines()) == 1, done.stderr


def test_an_older_folder_is_refused_by_its_version(finished, tmp_path):
    """Before the third version a file of its own kept the run."""
    shutil.copy(finished / "results.json", tmp_path)
    with h5netcdf.File(tmp_path / "results.nc", "w") as file:
        file.attrs["title"] = "older"
    with pytest.raises(workflows.BadInput, match=r"folder = [^\n]*version 2 [^\n]*expected 3; run it again$"):
        spindamp.load_results(tmp_path)


HOUSE = Path(workflows.__file__).parent


def test_published_schema_is_that_of_the_records():
    published = (HOUSE / "results.schema.json").read_text(encoding="utf-8")
    assert published == serialise.text(), "python -m workflows.io.serialise"


def test_every_quantity_has_a_unit_and_a_meaning():
    for quantity in serialise.quantities(SpeedPoint):
        assert quantity.kind in ("number", "integer", "string"), quantity
        unit = {"J": "N*m"}.get(quantity.unit, quantity.unit)  # which no scene has
        if unit not in ("", "1", "g", "rpm"):
            assert quantities.to_si(f"3 {unit}", quantities.Kind("", "", unit, 0.0, 9.0)) == 3.0
        assert (unit == "") is (quantity.kind == "string"), quantity
        assert quantity.meaning, quantity


def test_no_two_quantities_have_one_name_in_a_data_set(finished):
    found = workflows.dataset(workflows.load_results(finished))
    names = Counter(each.name for each in serialise.quantities(SpeedPoint))
    assert set(found.variables) <= names.keys()
    assert max(names.values()) == 1, names.most_common(3)


def test_columns_of_sweeps_are_those_of_runs():
    """By name and unit; a sweep adds what belongs to no speed of a run."""
    known = {each.name: each.unit for each in serialise.quantities(SpeedPoint)}
    mine = {quantity.name: quantity.unit for quantity in QUANTITIES}
    own = mine.keys() - known.keys()
    assert own == {"grade", "best_damping_ratio", "best_amplitude", "friction_needed", "sticks_out", "ball_mass"}
    assert all(known[name] == unit for name, unit in mine.items() if name not in own)


def _full():
    """A speed that has every part, with one mode, cycle and point of a curve."""
    from workflows.solve import results

    one = np.ones(1)
    parts = results.ErrorParts(*(0.0,) * 6)
    figures = dict.fromkeys(("peak", "peak_amplitude", "cutoff"), 1.0)
    figures |= {"range": (1.0, 2.0), "half": (1.0, 2.0), "amplitude": one, "damping_ratio": one}
    ring = dict.fromkeys((each.name for each in fields(results.Damping)), 1)
    ring |= {"outcome": "", "stopped": None, "release": (1.0, 0.0), "history": None, "path": None}
    ring |= {"amplitude_g": one, "sdc": one, "peak_velocity": one}
    damping = results.Damping(
        **ring | {"energy": results.Energy(*(1.0,) * 7), "modal_energies": (results.ModalEnergy(1, 1.0),)}
    )
    own = figures | dict.fromkeys((*OTHER_WAYS, "level"), results.Figures(**figures))
    own |= {"error": 0.0, "half_error": 0.0, "folds": (1.0, 2.0), "jump": (1.0, 2.0)}
    own |= dict.fromkeys(("tilt_share", "tilted_cutoff_g", "tilted_cutoff_ratio"), 1.0)
    point = SpeedPoint(1.0, 1.0, 1.0, 1.0, (results.Mode(1.0, "flap", parts, 0.0),))
    return replace(
        point,
        reduced=results.Reduced(*(1.0,) * 7),
        cavity_modes=(results.CavityMode(1, 1.0, (1.0, 0.0), (1.0, 0.0)),),
        damper=damping,
        damping_curve=results.OwnFigures(**own, pendulum=results.Pendulum((1.0, 1.0), (1.0, 1.0))),
    )


def test_every_number_of_the_document_is_in_the_data_set():
    """A number that each holds once, so that one missing, or one in the place of another, shows."""
    point = _full()
    run = Results(load("structure").scene, {}, (point,))
    document = workflows.document(run)["speeds"][0]
    numbers = sum(1 for _ in leaves(document))
    variables = serialise.variables(SpeedPoint, [point], "rpm").values()
    assert sum(values.size for _, values, _ in variables) == numbers
    assert sum(variable.size for variable in workflows.dataset(run).variables.values()) == numbers
    schema = serialise.schema()
    jsonschema.validate(document, schema["$defs"]["SpeedPoint"] | {"$defs": schema["$defs"]})


def test_a_speed_without_a_damper_has_neither_part_nor_columns():
    plain = SpeedPoint(omega=1.0, rpm=1.0, radius=1.0, load_g=1.0, modes=())
    results = Results(load("structure").scene, {}, (plain,))
    assert workflows.document(results)["speeds"] == [{"rpm": 1.0, "load_g": 1.0, "modes": []}]
    assert set(workflows.dataset(results).variables) == {"rpm", "load_g"}


def leaves(node):
    """Every number and text of plain data."""
    if isinstance(node, dict | list):
        for each in node.values() if isinstance(node, dict) else node:
            yield from leaves(each)
    else:
        yield node


TIMES = {"results.json": rb'"timings": \{[^}]*\},', "report.html": rb"Time in seconds: [^\n]*"}
"""What may differ between two runs."""


@dataclass(frozen=True)
class Again:
    """Another run: its folder, the most memory that it took, and what it had to warn of."""

    out: Path
    memory: float
    warnings: list[str]


@pytest.fixture(scope="module")
def again(finished, tmp_path_factory):
    """The paper's scene once more, in the place of an older run, by a process with another seed for its hashes."""
    out = tmp_path_factory.mktemp("again")
    for name in ("results.json", MANIFEST):
        shutil.copy(finished / name, out)
    seed = "1" if os.environ.get("PYTHONHASHSEED") != "1" else "2"
    warned = {"PYTHONWARNDEFAULTENCODING": "1", "PYTHONWARNINGS": "always::EncodingWarning"}
    environment = os.environ | {"PYTHONHASHSEED": seed} | warned
    done = python("-c", MEASURED, "run", "--out", out, "drawn", env=environment)
    assert done.returncode == 0, done.stderr
    return Again(out, float(done.stdout.split()[-1]), done.stderr.splitlines())


@pytest.mark.skipif(sys.platform != "linux", reason="the peak of a process is read from /proc")
def test_the_memory_promised_is_what_a_run_takes(again, spindamp):
    promised = spindamp.json("check", "paper")["sizes"]["memory"]
    assert 0.5 < promised / again.memory < 2.0


def test_every_text_file_says_its_encoding(again):
    """A file name, a title or a reason may hold letters that the system's own encoding has not."""
    ours = [line for line in again.warnings if "EncodingWarning" in line and "site-packages" not in line]
    assert not ours


def test_same_scene_same_bits(finished, again):
    names = {path.name for path in finished.iterdir()}
    assert names == {path.name for path in again.out.iterdir()}
    assert {"results.json", "results.nc", "modes.vtu", "report.html"} < names
    for name in names:
        one, other = (folder / name for folder in (finished, again.out))
        times = TIMES.get(name)
        if times is None:
            assert one.read_bytes() == other.read_bytes(), name
        else:
            assert len(re.findall(times, one.read_bytes())) == 1
            assert re.sub(times, b"", one.read_bytes()) == re.sub(times, b"", other.read_bytes()), name


def test_every_file_says_where_it_comes_from(finished, document):
    found = document["scene_sha256"]
    for name in ("results.json", "report.html", "modes.vtu"):
        text = (finished / name).read_text(encoding="utf-8")
        assert found in text, name
        assert document["versions"]["numpy"] in text, name
    with xr.open_dataset(finished / "results.nc", engine="h5netcdf") as data:
        assert data.attrs["scene_sha256"] == found
        assert f"numpy {document['versions']['numpy']}" in data.attrs["versions"]


def test_the_hash_can_be_checked_with_other_means(document):
    canonical = json.dumps(document["scene"], sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    assert hashlib.sha256(canonical.encode()).hexdigest() == document["scene_sha256"]


def _hash(scene):
    given = parse(scene)
    return provenance.scene_sha256(Results(given, selection.resolve(given), speeds=()))


def test_a_scene_has_one_hash_however_it_is_written(structure):
    same = changed(structure, damper__radius=0.001, rotor__hub_radius="0 mm", damper__formulation="consistent")
    assert _hash(dict(reversed(same.items()))) == _hash(structure)
    assert _hash(changed(structure, damper__radius=0.0010000001)) != _hash(structure)
    assert _hash(changed(structure, effects={"impact_friction": False})) != _hash(structure)


def test_a_mesh_file_counts_by_its_bytes(tmp_path, spindamp):
    mesh = MESHES / "plate_coarse.msh"
    shutil.copy(mesh, tmp_path)
    scene = {
        "plate": {"mesh": mesh.name, "thickness": 2e-3},
        "material": {"youngs_modulus": 1e11, "poissons_ratio": 0.3, "density": 4400.0},
        "rotor": {"speeds": [100.0], "modes": 1},
        "accuracy": {"frequency": 0.5},
    }
    out = tmp_path / "out"
    assert spindamp("run", scene, "--out", out).status == 0
    found = hashlib.sha256(mesh.read_bytes()).hexdigest()
    assert stored(out / "results.json")["mesh_sha256"] == found
    for name in ("report.html", "modes.vtu"):
        assert found in (out / name).read_text(encoding="utf-8"), name
    with xr.open_dataset(out / "results.nc", engine="h5netcdf") as data:
        assert data.attrs["mesh_sha256"] == found
