"""Makes docs/hard_cases.md from the tests that are marked `hard`:  python -m tests.hard_cases.page

Why a case is hard says its docstring, or the marker where that has other things to say.
"""

import ast
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "hard_cases.md"
HEAD = """# Hard cases

Cases in which codes of this kind lock, stall, lose events or make energy; each is a test. This page is made from
their markers by `python -m tests.hard_cases.page`.
"""


@dataclass(frozen=True)
class Case:
    """A marked test: its name, why it is hard, what it must keep, and where it is."""

    name: str
    why: str
    keeps: str
    test: str


def cases(folder: str) -> Iterator[Case]:
    """The marked tests of a folder's files whose name has the given part."""
    for path in sorted((ROOT / "tests").glob(folder)):
        for node in ast.parse(path.read_text()).body:
            if not isinstance(node, ast.FunctionDef):
                continue
            for mark in node.decorator_list:
                if isinstance(mark, ast.Call) and ast.unparse(mark.func) == "pytest.mark.hard":
                    said = {k.arg: ast.literal_eval(k.value) for k in mark.keywords}
                    name = node.name.removeprefix("test_").replace("_", " ")
                    where = f"{path.relative_to(ROOT)}::{node.name}"
                    why = said.get("why") or " ".join((ast.get_docstring(node) or "").split()).removesuffix(".")
                    yield Case(name, why, said["keeps"], where)


def page() -> str:
    """The page's text."""
    parts = [HEAD]
    for title, folders in (
        ("Plate", ("hard_cases/test_plate.py", "fem/test_fem_*.py")),
        ("Damper", ("hard_cases/test_damper.py", "damper/test_*.py")),
    ):
        rows = [case for folder in folders for case in cases(folder)]
        parts.append(f"\n## {title}\n\n| case | why it is hard | what it must keep | test |\n|---|---|---|---|\n")
        parts += [f"| {c.name} | {_cell(c.why)} | {_cell(c.keeps)} | `{c.test}` |\n" for c in rows]
    return "".join(parts)


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("<", "&lt;")


if __name__ == "__main__":
    PAGE.write_text(page())
    sys.exit(0)
