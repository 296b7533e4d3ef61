"""The rooms of the house: which may import which, and that no module leads back to itself."""

import grimp
import pytest

ROOMS = {
    "fem": (
        *("solid", "accuracy", "reduction", "sweep", "modes", "statics", "assembly", "theory", "plate"),
        *("modal_files", "rotor", "modal_model", "meshes"),
    ),
    "workflows": ("cli", "studies", "report", "io", "solve", "effects", "scene"),
}
"""From the top down: a room may import those after it."""

GROUND = {"fem": ("linalg",), "workflows": ("errors", "laws", "versions", "formatting", "docstrings", "progress")}
"""What imports no room, and any room may import."""

ATTIC = {"fem": ("output",), "workflows": ("pipeline",)}
"""What is over several rooms: the loop of a run."""


@pytest.fixture(scope="module")
def imports():
    """Every import there is, those for types and those inside functions too."""
    return grimp.build_graph("fem", "damper", "workflows", cache_dir=None)


@pytest.mark.parametrize("package", ROOMS)
def test_rooms_import_downwards(imports, package):
    rooms = [f"{package}.{room}" for room in ROOMS[package]]
    assert not [found for number, room in enumerate(rooms) for found in imported(imports, room, rooms[:number])]


def test_packages_import_in_one_direction(imports):
    """`fem` and `damper` know of nothing else; `workflows` of both."""
    assert not imported(imports, "fem", {"damper", "workflows"})
    assert not imported(imports, "damper", {"fem", "workflows"})


def test_numbers_need_no_prose(imports):
    """Sentences are made at output: of studies by their reports, of a run by the command line and by Python's call."""
    makers = {name for name in inside(imports, "workflows.studies") if name.endswith(("report", ".comparison"))}
    prose = {"workflows.report.remarks", "workflows.report.verdict"}
    found = imported(imports, "workflows.pipeline", prose) + imported(imports, "workflows.studies", prose)
    assert not [each for each in found if each[0] not in makers]


@pytest.mark.parametrize("package", GROUND)
def test_the_ground_floor_imports_no_room(imports, package):
    rooms = {f"{package}.{room}" for room in ROOMS[package]}
    assert not [found for name in GROUND[package] for found in imported(imports, f"{package}.{name}", rooms)]


@pytest.mark.parametrize("package", ["fem", "damper", "workflows"])
def test_every_module_is_in_a_room(imports, package):
    if package == "damper":
        assert all(module.count(".") <= 1 for module in inside(imports, package)), "damper is flat"
        return
    known = {*ROOMS[package], *GROUND[package], *ATTIC.get(package, ())}
    assert {module.split(".")[1] for module in inside(imports, package) if "." in module} <= known


@pytest.mark.parametrize("package", ["fem", "damper", "workflows"])
def test_no_circles(imports, package):
    """Imports inside functions count, and those for types."""
    left = {
        module: imports.find_modules_directly_imported_by(module) - {package} for module in inside(imports, package)
    }
    left.pop(package)
    while leaves := {module for module, needed in left.items() if not needed & left.keys()}:
        left = {module: needed for module, needed in left.items() if module not in leaves}
    assert not left, f"a circle among {sorted(left)}"


def inside(imports, name):
    """A module and all below it."""
    return {name, *imports.find_descendants(name)}


def imported(imports, name, rooms):
    """By whom of a module and all below it, and what, of modules within some rooms."""
    return [
        (module, found)
        for module in inside(imports, name)
        for found in imports.find_modules_directly_imported_by(module)
        if any(found == room or found.startswith(f"{room}.") for room in rooms)
    ]
