"""Every key of a scene, wrong in every way that applies to it: exit 2 and one short line that names the key.

The cases come from the model itself, so that a new key is bent from the day it exists. What the messages say in
detail is tested in `test_scene_errors`; here it is that there is one, for everything, and nothing else happens.
"""

import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.workflows.conftest import Raw, changed, refused, shipped_scene, text_of, toml
from workflows.scene.load import key_name
from workflows.scene.quantities import Table
from workflows.scene.scene import Effects, KnownModes, Scene, Structure

WRONG = tomllib.loads(
    Path(__file__)
    .with_name("malformed.toml")
    .read_text(encoding="utf-8")
    .replace("<zeros>", 400 * "0")
    .replace("<digits>", 15_000 * "F")
)


def _wrong(entry):
    """An entry's own values and those of its kinds, by what is wrong with them."""
    found = {what: value for kind in entry.get("of", ()) for what, value in _wrong(WRONG["kinds"][kind]).items()}
    found |= {what: value for what, value in entry.items() if what not in ("of", "without")}
    return {what: value for what, value in found.items() if what not in entry.get("without", ())}


BENT = {path: _wrong(entry) for path, entry in WRONG["keys"].items()}
BENT |= dict.fromkeys((f"effects.{name}" for name in Effects.model_fields), BENT.pop("effects.*"))


@dataclass(frozen=True)
class Case:
    """A scene to refuse: its text, and the key that the message must name."""

    text: str
    key: str
    hint: str = ""


def _tables():
    """The tables of a scene and their classes, of which [structure] has two."""
    found = [("structure", Structure), ("structure", KnownModes)]
    for name, field in Scene.model_fields.items():
        kinds = (field.annotation, *getattr(field.annotation, "__args__", ()))
        found += [(name, kind) for kind in kinds if isinstance(kind, type) and issubclass(kind, Table)]
    return found


def _with(scene, table, key, value):
    """A copy with one value set, from TOML text, or taken out by None."""
    return changed(scene, **{f"{table}__{key}" if table else key: None if value is None else Raw(value)})


def _in_space(table, **carrier):
    """A scene of a structure in space, but that its file is not there."""
    scene = shipped_scene("paper")
    plate_alone = ("plate", "material", "excitation") if table == "structure" else ("plate",)
    scene = {name: keys for name, keys in scene.items() if name not in plate_alone} | {table: carrier, "effects": {}}
    return _with(scene, "damper", "at", "[0.2, 0, 0]")


def _home(table, key):
    """A right scene in which this key can stand."""
    if table == "structure" and key in KnownModes.model_fields:
        units = {} if key == "modes" else {"unit": "mm", "mass_unit": "t"}
        return _in_space("structure", modes="a.npz", **units)
    if table == "blade" or f"{table}.{key}" in ("rotor.axis", "rotor.origin", "damper.direction", "damper.normal"):
        return _in_space("blade", mesh="a.inp", unit="mm", root="NROOT")
    if f"{table}.{key}" in ("excitation.at", "excitation.direction"):
        scene = _in_space("blade", mesh="a.inp", unit="mm", root="NROOT")
        return scene | {"excitation": {"orders": [3], "force": "1 N", "at": 1, "direction": [0, 0, 1]}}
    if table == "structure" or (table, key) == ("rotor", "radius"):
        return shipped_scene("structure")
    if table == "design":
        return shipped_scene("design")
    scene = shipped_scene("paper")
    if (table, key) == ("material", "name"):
        return scene | {"material": {}}
    if table == "damper" and key.startswith("ball_"):
        return _with(scene, "damper", "mass_ratio", None)
    if (table, key) == ("plate", "mesh"):
        return _with(_with(scene, "plate", "length", None), "plate", "width", None)
    return scene


def _bent():
    for path, values in BENT.items():
        table, _, key = path.rpartition(".")
        for what, value in values.items():
            scene = shipped_scene("paper") if what == "with a plate" else _home(table, key)
            named = key if not table else key_name([table, key])
            if path == "plate.length" and what == "shorter than thick":
                named = "[plate] thickness"
            if path in ("plate.thickness", "blade.root") and what == "a table":  # they may be one
                named += ".a"
            yield f"{path} {what}", Case(text_of(_with(scene, table, key, value)), named)


def _misspelt():
    for name, table in _tables():
        for key in table.model_fields:
            scene = _home(name, key)
            wrong = key[:-2] + key[-1] + key[-2] if len(key) > 2 else key + key
            value = toml(scene.get(name, {}).get(key, 1))
            bent = _with(_with(scene, name, key, None), name, wrong, value)
            if wrong != key:
                yield f"misspelt {name}.{key}", Case(text_of(bent), f"[{name}] {wrong}", f"did you mean '{key}'?")


def _missing():
    for shipped in ("paper", "structure"):
        scene = shipped_scene(shipped)
        for name, table in _tables():
            for key, field in table.model_fields.items():
                if key in scene.get(name, {}) and (field.is_required() or (name, key) in NEEDED[shipped]):
                    yield f"{shipped} without {name}.{key}", _case(scene, name, key, None, "missing")


NEEDED = {"paper": {("plate", "length"), ("plate", "width")}, "structure": {("rotor", "radius")}}
"""Keys that can be left out elsewhere, but not in these scenes."""


def _whole_tables():
    for shipped in ("paper", "structure"):
        scene = shipped_scene(shipped)
        for name in scene:
            if name == "title":
                continue
            rest = {table: keys for table, keys in scene.items() if table != name}
            if name not in ("effects", "excitation", "accuracy", "release"):
                # Without its structure a scene is taken for one of a plate that is not there.
                key = "[plate]" if name == "structure" else f"[{name}]"
                yield f"{shipped} without [{name}]", Case(text_of(rest), key, "missing")
            for what, value in (("a number", "1"), ("text", '"x"'), ("a list", "[1]"), ("true", "true")):
                yield (
                    f"{shipped}: {name} is {what}",
                    Case(text_of(rest | {name: Raw(value)}), f"[{name}]", "expected a table"),
                )
            array = text_of(scene).replace(f"[{name}]\n", f"[[{name}]]\n")
            yield f"{shipped}: {name} in double brackets", Case(array, f"[{name}]", "expected a table")
            swapped = name[:-2] + name[-1] + name[-2]
            misspelt = text_of(scene).replace(f"[{name}]\n", f"[{swapped}]\n")
            yield f"{shipped}: [{swapped}]", Case(misspelt, f"[{swapped}]", f"did you mean '{name}'?")


def _case(scene, table, key, value, hint=""):
    """One key set, or taken out by None, that the message must name."""
    return Case(text_of(_with(scene, table, key, value)), f"[{table}] {key}", hint)


def _combined():
    paper, structure, long = shipped_scene("paper"), shipped_scene("structure"), "x" * 5000
    tables = {name: keys for name, keys in paper.items() if name != "title"}
    shaken = paper | {"excitation": {"orders": [3], "force": "1 N"}}
    deep = text_of(_with(paper, "plate", "length", None)).replace("[material]", f"length{3000 * '.a'} = 1\n[material]")
    yield from {
        "a plate and a structure": Case(
            text_of(paper | {"structure": structure["structure"]}), "[plate]", "leave one out"
        ),
        "a material for a structure": Case(
            text_of(structure | {"material": paper["material"]}), "[material]", "leave one out"
        ),
        "hub radius of a structure": _case(structure, "rotor", "hub_radius", "1.0"),
        "stagger of a structure": _case(structure, "rotor", "stagger", '"1 deg"'),
        "place on a structure": _case(structure, "damper", "at", "[0.1, 0]"),
        "one negative side": _case(paper, "damper", "cavity", '"-3 mm"', "expected more than 0"),
        "two masses": Case(text_of(_with(paper, "damper", "mass", '"1 g"')), "[damper] mass_ratio", "leave one out"),
        "no mass": _case(paper, "damper", "mass_ratio", None),
        "a mesh and a length": Case(text_of(_with(paper, "plate", "mesh", '"a.msh"')), "[plate] length", "leave"),
        "a table below a value": Case("title.a = 1\n" + text_of(tables), "title"),
        "a key below a key": _case(paper, "plate", "length", '{ value = 20, unit = "cm" }', "expected a length"),
        "deeply below": Case(deep, "[plate] length"),
        "a key of 5000 letters": Case(text_of(_with(paper, "plate", long, "1")), f"[plate] {'x' * 50}"),
        "a value of 5000 letters": _case(paper, "plate", "length", f'"{long}"'),
        "a key on two lines": Case(text_of(_with(paper, "plate", '"a\\nb"', "1")), "[plate] a b"),
    }.items()
    for key, value in (("at", "[0.1, 0]"), ("at", "1"), ("direction", "[0, 0, 1]")):
        case = _case(shaken, "excitation", key, value, "belongs to a [blade]")
        yield f"{key} = {value} of a force on a plate", case
    for key in ("length", "speeds", "radius", "cycles", "friction"):
        yield f"{key} outside its table", Case(text_of(paper | {key: 1}), key, "belongs in [")


CASES = {name: case for make in (_bent, _misspelt, _missing, _whole_tables, _combined) for name, case in make()}
GROUPS = sorted({name.split()[0] for name in CASES})
"""Cases by the first word of their names: a key's are tried together."""


def test_every_key_is_bent():
    keys = {f"{name}.{key}" for name, table in _tables() for key in table.model_fields}
    assert set(BENT) - {"title"} == keys
    assert len(CASES) >= 200


@pytest.mark.parametrize("group", GROUPS)
def test_malformed(group, spindamp, tmp_path):
    """Refused in one short line: file, key, and what would be right."""
    for what, case in CASES.items():
        if what.split()[0] == group:
            (tmp_path / "bad.toml").write_text(case.text, encoding="utf-8")
            err = refused(spindamp("run", "bad.toml", "--out", "out"), f"bad.toml: {case.key}", case.hint)
            assert len(err) < 300, what
            said = err.removeprefix(f"spindamp: bad.toml: {case.key}")
            assert said[0] in " :…x", (what, err)  # the whole key, and not the beginning of another
            assert any(word in said for word in RIGHT), (what, err)
            assert [path.name for path in tmp_path.iterdir()] == ["bad.toml"], what


RIGHT = ("expected", "missing", "did you mean", "unknown", "belongs", "leave", "no such file", "negative", "one of")
"""A message has one of these: what would be right, or that it is not known or not there."""
