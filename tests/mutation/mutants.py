"""The faults: one small change of the syntax tree each."""

from __future__ import annotations

import ast
import copy
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
}
OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
}
_ASIDE = (ast.JoinedStr, ast.Raise, ast.ImportFrom, ast.Import, ast.AnnAssign, ast.arguments)
"""What is left alone: texts, imports, types, defaults."""


@dataclass(frozen=True)
class Mutant:
    """A file of `damper` with one change: what was and what is now, nodes of its tree."""

    file: str
    tree: ast.Module
    old: ast.AST
    new: ast.AST

    @property
    def name(self) -> str:
        """One line that says what was changed."""
        line = getattr(self.old, "lineno", 0)
        return f"{self.file}:{line}: {ast.unparse(self.old)}  ->  {ast.unparse(self.new)}"

    @property
    def source(self) -> str:
        """The whole file; it is made for those that are tried, not for all among which they are drawn."""
        changed = _Swap(self.old, self.new).visit(copy.deepcopy(self.tree, {id(self.old): self.old}))
        return ast.unparse(ast.fix_missing_locations(changed))


def mutants(path: Path) -> Iterator[Mutant]:
    """Every mutant of a file."""
    tree = ast.parse(path.read_text())
    for target in _targets(tree):
        for replacement in _replacements(target):
            yield Mutant(path.name, tree, target, replacement)


class _Swap(ast.NodeTransformer):
    """Puts one node in the place of another."""

    def __init__(self, old: ast.AST, new: ast.AST) -> None:
        self.old, self.new = old, new

    def visit(self, node: ast.AST) -> ast.AST:
        return self.new if node is self.old else super().visit(node)


def _targets(node: ast.AST) -> Iterator[ast.expr | ast.stmt]:
    """Nodes of function bodies that a change can be made to; signatures and decorators are not among them."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, _ASIDE) or (isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test)):
            continue
        if isinstance(child, ast.FunctionDef):
            for part in child.body:
                yield from _inside(part)
        elif isinstance(child, ast.ClassDef):
            yield from _targets(child)


def _inside(node: ast.AST) -> Iterator[ast.expr | ast.stmt]:
    if isinstance(node, _ASIDE):
        return
    if isinstance(node, ast.expr | ast.stmt):
        yield node
    for child in ast.iter_child_nodes(node):
        yield from _inside(child)


def _replacements(node: ast.AST) -> Iterator[ast.expr | ast.stmt]:
    match node:
        case ast.Compare(left, [op], right) if type(op) in COMPARISONS:
            yield ast.Compare(left, [COMPARISONS[type(op)]()], right)
        case ast.BinOp(left, op, right) if type(op) in OPERATORS:
            yield ast.BinOp(left, OPERATORS[type(op)](), right)
        case ast.BoolOp(op, values):
            yield ast.BoolOp(ast.And() if isinstance(op, ast.Or) else ast.Or(), values)
        case ast.UnaryOp(ast.Not() | ast.USub(), operand):
            yield operand
        case ast.AugAssign(target, op, value) if type(op) in OPERATORS:
            yield ast.AugAssign(target, OPERATORS[type(op)](), value)
            yield ast.Pass()
        case ast.Assign([ast.Attribute()], _) | ast.Expr(ast.Call()) | ast.Continue() | ast.Break():
            yield ast.Pass()
        case ast.Constant(bool() as value):
            yield ast.Constant(not value)
        case ast.Constant(int() | float() as value):
            yield ast.Constant(value + 1 if value == 0 else 2 * value)
