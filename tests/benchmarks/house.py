"""The shape of the code: files, floors, circles, rooms, what is written twice, long functions, long lists of arguments.

    python -m tests.benchmarks.house                # of this tree
    python -m tests.benchmarks.house OTHER HERE     # of several, side by side

Floors are the modules on the longest chain of imports, a circle counting as one; in brackets with imports inside
functions and for types. A room is a folder or a file directly below the package, seen from outside. Twice means six
lines of code in a row or more, docstrings and imports apart, that agree.
"""

from __future__ import annotations

import ast
import sys
from collections import defaultdict
from functools import cache
from itertools import combinations
from pathlib import Path

PACKAGES = ("fem", "damper", "workflows")
LINES, ARGUMENTS, BRANCHES, PAGE, SAME = 50, 6, 15, 250, 6

Graph = dict[str, set[str]]
Function = ast.FunctionDef | ast.AsyncFunctionDef


def modules(tree: Path, package: str) -> dict[str, ast.Module]:
    """Every module of a package by its dotted name."""
    found = {}
    for path in sorted((tree / package).rglob("*.py")):
        parts = path.relative_to(tree).with_suffix("").parts
        name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        found[name] = ast.parse(path.read_text(encoding="utf-8"))
    return found


def imports(known: dict[str, ast.Module], *, everywhere: bool) -> Graph:
    """Which module imports which of the same package, at its top or anywhere; the package's own `__init__` aside."""
    graph: Graph = {name: set() for name in known}
    for name, module in known.items():
        for node in ast.walk(module) if everywhere else module.body:
            if isinstance(node, ast.Import):
                graph[name] |= {each.name for each in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                inner = {f"{node.module}.{each.name}" for each in node.names}
                graph[name] |= {each if each in known else node.module for each in inner}
        graph[name] &= {each for each in known if "." in each and each != name}
    return graph


def rooms(graph: Graph) -> Graph:
    """Which folder or file directly below the package imports which other."""

    def room(name: str) -> str:
        return ".".join(name.split(".")[:2])

    found: Graph = {room(name): set() for name in graph if "." in name}
    for name in graph.keys() - set(PACKAGES):
        found[room(name)] |= {room(each) for each in graph[name]} - {room(name)}
    return found


def reached(graph: Graph) -> Graph:
    """What each module leads to."""
    found: Graph = {}
    for name in graph:
        seen: set[str] = set()
        left = [name]
        while left:
            for each in graph[left.pop()] - seen:
                seen.add(each)
                left.append(each)
        found[name] = seen
    return found


def circles(graph: Graph) -> list[set[str]]:
    """Modules that lead back to themselves, those of a circle together."""
    leads = reached(graph)
    found = {frozenset(b for b in leads[a] if a in leads[b]) for a in graph if a in leads[a]}
    return [set(each) for each in found]


def floors(graph: Graph) -> int:
    """Modules on the longest chain of imports, a circle being one."""
    home = {name: name for name in graph}
    for circle in circles(graph):
        home |= dict.fromkeys(circle, min(circle))
    below: Graph = defaultdict(set)
    for name, needed in graph.items():
        below[home[name]] |= {home[each] for each in needed} - {home[name]}

    @cache
    def height(name: str) -> int:
        return 1 + max(map(height, below[name]), default=0)

    return max(map(height, set(home.values())), default=0)


def lines_of(module: ast.Module) -> list[str]:
    """The code alone."""
    for node in ast.walk(module):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            body[:] = [each for each in body if not _said(each)] or [ast.Pass()]
    text = (line.strip() for line in ast.unparse(module).splitlines())
    return [line for line in text if line and not line.startswith(("import ", "from ", "pass"))]


def _said(node: ast.stmt) -> bool:
    """Whether it is a docstring."""
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str)


def twice(texts: dict[str, list[str]]) -> int:
    """Pairs of stretches of code that are the same."""
    places = defaultdict(list)
    for name, lines in texts.items():
        for k in range(len(lines) - SAME + 1):
            places[tuple(lines[k : k + SAME])].append((name, k))
    pairs = {pair for each in places.values() for pair in combinations(sorted(each), 2)}
    return sum(((a, i - 1), (b, j - 1)) not in pairs for (a, i), (b, j) in pairs)


def functions(known: dict[str, ast.Module]) -> list[Function]:
    """All functions and methods."""
    nodes = (node for module in known.values() for node in ast.walk(module))
    return [node for node in nodes if isinstance(node, Function)]


def arguments(function: Function) -> int:
    """How many a caller may give."""
    given = function.args
    names = [each.arg for each in (*given.posonlyargs, *given.args, *given.kwonlyargs)]
    return len(names) - (names[:1] in (["self"], ["cls"]))


def branches(function: Function) -> int:
    """McCabe's number, with comprehensions and expressions that branch."""
    count, forks = 1, (ast.If, ast.For, ast.While, ast.ExceptHandler, ast.IfExp, ast.comprehension, ast.match_case)
    for node in ast.walk(function):
        count += isinstance(node, forks) + (len(node.values) - 1 if isinstance(node, ast.BoolOp) else 0)
    return count


def measures(tree: Path, package: str) -> dict[str, str]:
    """The column of a package in a tree."""
    known = modules(tree, package)
    top, everywhere = imports(known, everywhere=False), imports(known, everywhere=True)
    heads = functions(known)
    pages = [len(path.read_text(encoding="utf-8").splitlines()) for path in (tree / package).rglob("*.py")]
    return {
        "files": str(len(pages)),
        f"files of over {PAGE} lines": str(sum(page > PAGE for page in pages)),
        "floors": f"{floors(top)} ({floors(everywhere)})",
        "circles": f"{len(circles(top))} ({len(circles(everywhere))})",
        "floors of rooms": f"{floors(rooms(top))} ({floors(rooms(everywhere))})",
        "circles of rooms": f"{len(circles(rooms(top)))} ({len(circles(rooms(everywhere)))})",
        f"functions of over {LINES} lines": str(sum((each.end_lineno or 0) - each.lineno >= LINES for each in heads)),
        f"functions of over {ARGUMENTS} arguments": str(sum(arguments(each) > ARGUMENTS for each in heads)),
        f"functions of over {BRANCHES} branches": str(sum(branches(each) > BRANCHES for each in heads)),
        "stretches written twice": str(twice({name: lines_of(module) for name, module in known.items()})),
    }


def main(*trees: str) -> int:
    """A table for each package, with a column for each tree."""
    paths = [Path(tree).resolve() for tree in trees or (".",)]
    for package in PACKAGES:
        columns = [measures(path, package) for path in paths]
        print(f"\n{package:<36}" + "".join(f"{path.name:>14}" for path in paths))
        for name in columns[0]:
            print(f"  {name:<34}" + "".join(f"{column[name]:>14}" for column in columns))
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
