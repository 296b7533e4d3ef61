"""One style of docstrings: what is raised stands under `Raises:`, an exception a line."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
INLINE = re.compile(r"(?:^|[.;:] )Raises `?[A-Z]")


@pytest.mark.parametrize("package", ["fem", "workflows"])
def test_what_is_raised_has_its_place(package):
    for path in (ROOT / package).rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.ClassDef):
                text = " ".join((ast.get_docstring(node) or "").split())
                assert not INLINE.search(text), f"{path.name}:{node.lineno} {node.name}"


def test_no_test_patches_a_private_name():
    found = []
    for path in (ROOT / "tests").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and _called(node) in {"setattr", "patch", "object"}:
                texts = [each.value for each in node.args[:2] if isinstance(each, ast.Constant)]
                names = [text.rpartition(".")[2] for text in texts if isinstance(text, str)]
                found += [
                    (path.name, node.lineno, name)
                    for name in names
                    if name.startswith("_") and not name.startswith("__")
                ]
    assert not found


def _called(node):
    return getattr(node.func, "attr", getattr(node.func, "id", None))
