"""The docstrings beneath the fields of a class: what JSON schemas and messages say of each."""

import ast
import inspect
import sys
from collections.abc import Iterator
from functools import cache
from itertools import pairwise


def of_fields(record: type) -> dict[str, str]:
    """The docstring beneath each field of a class and its bases, on one line.

    A module is parsed once; pydantic's `use_attribute_docstrings` parses it for each class.
    """
    return {
        name: text
        for base in reversed(record.__mro__)
        for name, text in _of_module(base.__module__).get(base.__name__, {}).items()
    }


@cache
def _of_module(module: str) -> dict[str, dict[str, str]]:
    if not module.startswith(("workflows.", "__main__")):
        return {}
    body = ast.parse(inspect.getsource(sys.modules[module])).body
    return {each.name: dict(_documented(each)) for each in body if isinstance(each, ast.ClassDef)}


def _documented(record: ast.ClassDef) -> Iterator[tuple[str, str]]:
    for field, text in pairwise(record.body):
        match field, text:
            case ast.AnnAssign(target=ast.Name(id=name)), ast.Expr(value=ast.Constant(value=str(words))):
                yield name, " ".join(words.split())
