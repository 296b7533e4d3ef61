"""Who may import whom, what is public, and what light commands leave unloaded."""

from __future__ import annotations

import ast
from importlib import import_module
from inspect import isfunction
from pathlib import Path

import pytest

import spindamp
from tests.workflows.conftest import python
from workflows.cli.commands import COMMANDS

ROOT = Path(__file__).parents[2]
PACKAGES = ("fem", "damper", "workflows")
MAY_IMPORT = {"fem": {"fem"}, "damper": {"damper"}, "workflows": set(PACKAGES)}
HEAVY = {
    "h5netcdf",
    "h5py",
    "jinja2",
    "llvmlite",
    "matplotlib",
    "meshio",
    "numba",
    "pandas",
    "pyvista",
    "rich",
    "scipy.linalg",
    "scipy.sparse",
    "skfem",
    "vtkmodules",
    "xarray",
}


def _imports(source: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(source.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.add(node.module.split(".")[0])
    return found


@pytest.mark.parametrize("package", PACKAGES)
def test_one_direction(package: str) -> None:
    for source in (ROOT / package).rglob("*.py"):
        ours = _imports(source) & set(PACKAGES)
        assert ours <= MAY_IMPORT[package], source


@pytest.mark.parametrize("package", PACKAGES)
def test_public_names_are_complete(package: str) -> None:
    module = import_module(package)
    tree = ast.parse((ROOT / package / "__init__.py").read_text(encoding="utf-8"))
    offered = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(package)
        for alias in node.names
    }
    assert list(module.__all__) == sorted(module.__all__)
    assert set(module.__all__) == offered
    for name in module.__all__:
        assert getattr(module, name) is not None
    with pytest.raises(AttributeError):
        module.nonsense  # noqa: B018


def test_what_a_command_does_python_can_call() -> None:
    """All but what shows something and returns nothing."""
    functions = {name for name, found in vars(spindamp).items() if isfunction(found) and found.__module__ == "spindamp"}
    assert functions <= set(spindamp.__all__)
    assert {command.__name__ for command in COMMANDS} - functions == {"view", "check"}


def _loaded(statement: str) -> set[str]:
    code = f"import sys\n{statement}\nprint('\\n' + ' '.join(sys.modules))"
    done = python("-c", code)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_alone_loads_nothing_heavy(package: str) -> None:
    assert not _loaded(f"import {package}") & HEAVY


def test_light_commands_load_nothing_heavy() -> None:
    assert not _loaded("from workflows.cli.main import main\nmain(['--version'])\nmain(['--help'])") & HEAVY


def test_check_loads_no_solver_and_draws_nothing() -> None:
    """Said in words and as JSON; what solves and compiles takes longer to load than a check of a rectangle takes."""
    check = "main(['check', 'paper'])\nmain(['check', 'paper', '--json'])"
    assert not _loaded(f"from workflows.cli.main import main\n{check}") & (HEAVY | {"scipy", "pint"})


def test_a_damper_alone_loads_no_plate() -> None:
    loaded = _loaded("from workflows.cli.main import main\nmain(['ringdown', 'structure', '--json'])")
    assert not loaded & {"skfem", "matplotlib", "xarray", "pyvista", "jinja2"}
