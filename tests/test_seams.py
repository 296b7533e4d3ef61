"""Tests change the code under test by names that it offers, and so do not break where only its inside moves."""

import ast
from pathlib import Path

HERE = Path(__file__).parent


def test_no_test_patches_a_private_name():
    found = []
    for path in HERE.rglob("*.py"):
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
