"""Every key of a scene, wrong in every way that applies to it: exit 2 and one short line that names the key.

The cases come from the model itself, so that a new key is bent from the day it exists. What the messages say in
detail is tested in `test_scene_errors`; here it is that there is one, for everything, and nothing else happens.
"""

import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from tests.workflows.conftest import Command, refused, toml
from workflows.scene.load import SHIPPED, key_name
from workflows.scene.quantities import Table
from workflows.scene.scene import Effects, KnownModes, Scene, Structure

Raw = dict[str, dict[str, str]]
"""A scene as table → key → TOML text, so that a value can be anything a file can hold."""

NEVER_RIGHT = {
    "a date": "2026-01-01",
    "a time": "07:32:00",
    "a table": "{ a = 1 }",
    "an empty list": "[]",
    "a list in a list": "[[1]]",
    "an empty text": '""',
    "a word": '"nonsense"',
    "code": "\"__import__('os').system('true')\"",
}
NO_NUMBER = NEVER_RIGHT | {
    "true": "true",
    "not a number": "nan",
    "infinite": "inf",
    "of 400 digits": "1" + "0" * 400,
    "of 60000 binary digits": "0x" + "F" * 15_000,
}
NO_QUANTITY = NO_NUMBER | {
    "a list": "[1.0]",
    "text without a unit": '"0.5"',
    "a unit without a number": '"cm"',
    "an unknown unit": '"1 furlong"',
    "another dimension": '"1 N*s"',
    "a line break in the unit": '"1 kg\\n/m^3"',
    "overflowing": '"1e999 m"',
    "out of range": "1e300",
    "vanishing": "1e-300",
    "two numbers": '"1 2 m"',
}
NO_PLAIN = NO_NUMBER | {"a list": "[1.0]", "a number in quotes": '"0.3"', "a percentage": '"30 %"'}
NO_WHOLE = NO_PLAIN | {"a fraction": "1.5", "zero": "0", "negative": "-1"}
NO_PAIR = NO_NUMBER | {
    "one number": "1.0",
    "one of two": "[1.0]",
    "three": "[1.0, 1.0, 1.0]",
    "not a number inside": "[1.0, nan]",
    "infinite inside": "[inf, 1.0]",
    "true inside": "[true, 1.0]",
    "another dimension inside": '["1 s", 1.0]',
    "a list inside": "[1.0, [1.0]]",
    "of 400 digits inside": "[1.0, 1" + "0" * 400 + "]",
}
NO_VECTOR = {k: v for k, v in NO_PAIR.items() if k != "three"} | {"two": "[1.0, 1.0]"}
NO_FILE = {"a number": "1", "a list": "[1]", "true": "true", "blank": '"  "', "nowhere": '"no.file"', "a folder": '"."'}
NO_UNIT = {
    "a number": "1",
    "true": "true",
    "a time": '"s"',
    "misspelt": '"mmm"',
    "with a number": '"2 mm"',
    "blank": '" "',
}
NO_SWITCH = NO_NUMBER | {"one": "1", "yes": '"yes"', "another case": '"Auto"'}
del NO_SWITCH["true"]
NO_TEXT = {k: v for k, v in NO_NUMBER.items() if '"' not in v} | {"two lines": '"a\\nb"', "a control": '"a\\u0000b"'}
NO_CHOICE = NO_NUMBER | {"a number": "1", "a list": '["auto"]'}
NEGATIVE = {"negative": "-1.0"}
ZERO = {"zero": "0"}
ABOVE_ONE = {"above one": "1.0001", "huge": "1e9"}

NO_LEVEL = {k: v for k, v in NO_QUANTITY.items() if k != "a list"} | ZERO | NEGATIVE
BENT: dict[str, dict[str, str]] = {
    "title": NO_TEXT | {"too long": '"' + "a" * 201 + '"'},
    "plate.length": NO_QUANTITY | NEGATIVE | ZERO | {"shorter than thick": '"1 mm"'},
    "plate.width": NO_QUANTITY | NEGATIVE | ZERO | {"thousands of times wider than long": '"2 km"'},
    "plate.thickness": NO_QUANTITY | NEGATIVE | ZERO | {"above the width": '"9 cm"', "a film": '"1 nm"'},
    "plate.mesh": NO_TEXT | {"blank": '"  "', "nowhere": '"no.msh"', "a folder": '"."', "a device": '"/dev/zero"'},
    "plate.mesh_unit": NO_TEXT
    | NEVER_RIGHT
    | {"a mass": '"kg"', "misspelt": '"mmm"', "with a number": '"2 mm"', "blank": '" "', "without a mesh": '"mm"'},
    "plate.theory": NO_CHOICE | {"another case": '"Mindlin"', "misspelt": '"kirchhof"'},
    "plate.tip_mass": NO_QUANTITY | NEGATIVE,
    "plate.tip_mass_at": NO_PAIR | {"beside a damper's": '["20 cm", 0]'},
    "plate.root": {"a number": "1", "text": '"springs"', "a list": "[1]", "true": "true", "a quantity": '"5e9 N/m/m"'},
    "material.name": NO_CHOICE | {"another case": '"Steel"', "what no plate is made of": '"lead"'},
    "material.youngs_modulus": NO_QUANTITY | NEGATIVE | ZERO,
    "material.poissons_ratio": NO_PLAIN | {"a half": "0.5", "minus one": "-1.0"} | ABOVE_ONE,
    "material.density": NO_QUANTITY | NEGATIVE | ZERO,
    "rotor.speeds": NO_NUMBER
    | {
        "one speed": '"3500 rpm"',
        "of frequency": '["50 Hz"]',
        "negative inside": '["-1 rpm"]',
        "not a number inside": "[nan]",
        "twice the same": "[1, 1.0]",
        "beyond every plate": '["1e7 rpm"]',
        "practically at rest": '["0 rpm", "1e-6 rpm"]',
        "true inside": "[true]",
        "a ladder without count": "{ start = 0, stop = 1 }",
        "a ladder with more": "{ start = 0, stop = 1, count = 2, step = 1 }",
        "a ladder downwards": "{ start = 2, stop = 1, count = 2 }",
        "a ladder of half steps": "{ start = 0, stop = 1, count = 2.5 }",
        "a ladder of none": "{ start = 0, stop = 1, count = 0 }",
        "a ladder of true": "{ start = 0, stop = 1, count = true }",
        "a ladder without end": "{ start = 0, stop = 1, count = 1000000000 }",
        "a ladder to nan": "{ start = 0, stop = nan, count = 2 }",
        "a ladder of text": '{ start = "a", stop = 1, count = 2 }',
        "a ladder finer than rounding": "{ start = 1.0, stop = 1.0000000000000002, count = 9 }",
    },
    "rotor.hub_radius": NO_QUANTITY | NEGATIVE,
    "rotor.radius": NO_QUANTITY | NEGATIVE | ZERO | {"with a plate": '"20 cm"'},
    "rotor.stagger": NO_QUANTITY | {"beyond half a turn": '"400 deg"', "degrees without a unit": "45", "back": "-4"},
    "rotor.precone": NO_QUANTITY | {"beyond upright": '"91 deg"', "degrees without a unit": "5", "of a damper": "0.1"},
    "rotor.gravity": NO_QUANTITY | NEGATIVE | ZERO,
    "rotor.modes": NO_WHOLE | {"too many": "201"},
    **{f"effects.{name}": NO_SWITCH for name in Effects.model_fields},
    "damper.at": NO_PAIR
    | {"beyond the tip": '["21 cm", 0]', "beside": '[0.1, "5 cm"]', "at the root": "[0, 0]", "behind": "[-0.1, 0]"},
    "damper.mass_ratio": NO_PLAIN | NEGATIVE | ZERO | {"beyond sense": "1e10"},
    "damper.mass": NO_QUANTITY | NEGATIVE | ZERO,
    "damper.ball_density": NO_QUANTITY | NEGATIVE | ZERO,
    "damper.ball_material": NO_CHOICE | {"another case": '"Steel"', "misspelt": '"led"'},
    "damper.housing": NO_QUANTITY | NEGATIVE | ZERO,
    "damper.count": NO_WHOLE,
    "damper.radius": NO_QUANTITY | NEGATIVE | ZERO,
    "damper.cavity": NO_PAIR
    | {"smaller than the ball": '["2.5 mm", "1.9 mm"]', "negative": "[-1.0, -1.0]"}
    | {"thicker than the plate": '["1 cm", "3 mm"]', "wider than the plate": '["3 mm", "81 mm"]'},
    "damper.restitution": NO_PLAIN | NEGATIVE | ABOVE_ONE,
    "damper.friction": NO_PLAIN | NEGATIVE | {"beyond sense": "1e7"},
    "damper.rolling_friction": NO_QUANTITY | NEGATIVE,
    "damper.formulation": NO_CHOICE | {"another case": '"Printed"', "misspelt": '"consistant"'},
    "damper.damping_ratio": NO_PLAIN | NEGATIVE | ABOVE_ONE | {"one": "1"},
    "damper.sticking_ratio": NO_PLAIN | NEGATIVE | ABOVE_ONE | ZERO,
    "release.displacement": NO_PAIR | {"nothing": "[0, 0]", "farther than the plate is long": "[0.21, 0]"},
    "release.acceleration": NO_PAIR | {"beside displacement": '["1 g", 0]'},
    "release.ratio": NO_PLAIN | NEGATIVE | ZERO | {"beyond sense": "1e10", "beside displacement": "0.3"},
    "damper.floor_radius": NO_QUANTITY | ZERO | NEGATIVE | {"three": '["2 cm", "2 cm", "2 cm"]'},
    "structure.floor_tilt": NO_QUANTITY | {"three": "[1.0, 1.0, 1.0]"},
    "excitation.orders": NO_WHOLE | {"a fraction inside": "[2, 2.5]", "twice": "[2, 2]"},
    "excitation.force": NO_LEVEL | {"twice": '["1 N", "1 N"]'},
    "excitation.pressure": NO_LEVEL | {"beside a force": '"100 Pa"'},
    "excitation.base": NO_LEVEL | {"beside a force": '"1 g"'},
    "design.ball_material": NO_NUMBER | {"no material": '["wood"]', "a number inside": "[1]"},
    "design.ball_diameter": NO_NUMBER | {"descending": "[4e-3, 2e-3]", "zero inside": "[0, 1e-3]"},
    "design.clearance": NO_NUMBER | {"descending": "[4e-3, 2e-3]", "zero inside": "[0, 1e-3]"},
    "design.floor_radius": NO_NUMBER | {"misspelt": '["flatt", "8 mm"]'},
    "design.count": NO_NUMBER | {"zero inside": "[0, 2]", "a fraction inside": "[1.5]"},
    "design.place": NO_NUMBER | {"descending": "[0.2, 0.1]", "negative inside": "[-0.1, 0.1]"},
    "design.mass": NO_QUANTITY | NEGATIVE | ZERO,
    "design.wall": NO_QUANTITY | NEGATIVE,
    "design.amplitude": NO_PAIR | {"descending": "[5e-3, 2e-3]", "from nothing": "[0, 2e-3]"},
    "release.cycles": NO_NUMBER | NEGATIVE | ZERO | {"too many": "1e10", "another case": '"Auto"'},
    "accuracy.frequency": NO_PLAIN | NEGATIVE | ZERO | ABOVE_ONE,
    "accuracy.damping": NO_PLAIN | NEGATIVE | ZERO | ABOVE_ONE,
    "structure.frequency": NO_QUANTITY | NEGATIVE | ZERO | {"of light": '"1 GHz"', "a cycle a year": '"3e-8 Hz"'},
    "structure.mass": NO_QUANTITY | NEGATIVE | ZERO,
    "structure.modes": NO_FILE | {"of no speed": '{ "fast" = "a.frd" }', "at a length": '{ "1 m" = "a.frd" }'},
    "structure.unit": NO_UNIT,
    "structure.mass_unit": NO_UNIT | {"a length": '"mm"'},
    "blade.mesh": NO_FILE,
    "blade.unit": NO_UNIT,
    "blade.root": NO_TEXT,
    "blade.size": NO_QUANTITY | NEGATIVE | ZERO,
    "rotor.axis": NO_VECTOR | {"of no length": "[0, 0, 0]"},
    "rotor.origin": NO_VECTOR,
    "damper.direction": NO_VECTOR | {"of no length": "[0, 0, 0]"},
    "damper.normal": NO_VECTOR | {"of no length": "[0, 0, 0]"},
    "excitation.at": {"two lengths": "[0.1, 0]", "a switch": "true", "nothing": '""', "no node": "-1"},
    "excitation.direction": NO_VECTOR | {"of no length": "[0, 0, 0]"},
    "damper.floor_material": NO_CHOICE | {"another case": '"Steel"', "misspelt": '"stel"'},
    "design.hardness_ratio": NO_PLAIN | NEGATIVE | ZERO,
    "design.yield_ratio": NO_PLAIN | NEGATIVE | ZERO,
}


@dataclass(frozen=True)
class Case:
    """A scene to refuse: its text, and the key that the message must name."""

    text: str
    key: str
    hint: str = ""


def _tables() -> list[tuple[str, type[Table]]]:
    """The tables of a scene and their classes, of which [structure] has two."""
    found: list[tuple[str, type[Table]]] = [("structure", Structure), ("structure", KnownModes)]
    for name, field in Scene.model_fields.items():
        kinds = (field.annotation, *getattr(field.annotation, "__args__", ()))
        found += [(name, kind) for kind in kinds if isinstance(kind, type) and issubclass(kind, Table)]
    return found


def _right(shipped: str) -> Raw:
    """A shipped scene as raw text, to be bent."""
    data: dict[str, Any] = tomllib.loads((SHIPPED / f"{shipped}.toml").read_text(encoding="utf-8"))
    top = {"": {key: toml(value) for key, value in data.items() if not isinstance(value, dict)}}
    return top | {
        name: {key: toml(value) for key, value in table.items()}
        for name, table in data.items()
        if isinstance(table, dict)
    }


def _text(raw: Raw) -> str:
    lines = []
    for name, table in raw.items():
        lines += [f"[{name}]"] if name else []
        lines += [f"{key} = {value}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def _with(raw: Raw, table: str, key: str, value: str | None) -> Raw:
    """A copy with one value set, or taken out by None."""
    new = {name: dict(keys) for name, keys in raw.items()}
    place = new.setdefault(table, {})
    if value is None:
        place.pop(key, None)
    else:
        place[key] = value
    return new


def _in_space(table: str, **carrier: str) -> Raw:
    """A scene of a structure in space, but that its file is not there."""
    raw = _right("paper")
    plate_alone = ("plate", "material", "excitation") if table == "structure" else ("plate",)
    raw = {name: keys for name, keys in raw.items() if name not in plate_alone} | {table: carrier}
    raw["effects"] = {}
    return _with(raw, "damper", "at", "[0.2, 0, 0]")


def _home(table: str, key: str) -> Raw:
    """A right scene in which this key can stand."""
    if table == "structure" and key in KnownModes.model_fields:
        units = {} if key == "modes" else {"unit": '"mm"', "mass_unit": '"t"'}
        return _in_space("structure", modes='"a.npz"', **units)
    if table == "blade" or f"{table}.{key}" in ("rotor.axis", "rotor.origin", "damper.direction", "damper.normal"):
        return _in_space("blade", mesh='"a.inp"', unit='"mm"', root='"NROOT"')
    if f"{table}.{key}" in ("excitation.at", "excitation.direction"):
        raw = _in_space("blade", mesh='"a.inp"', unit='"mm"', root='"NROOT"')
        return raw | {"excitation": {"orders": "[3]", "force": '"1 N"', "at": "1", "direction": "[0, 0, 1]"}}
    if table == "structure" or (table, key) == ("rotor", "radius"):
        return _right("structure")
    if table == "design":
        return _right("design")
    raw = _right("paper")
    if (table, key) == ("material", "name"):
        return raw | {"material": {}}
    if table == "damper" and key.startswith("ball_"):
        return _with(raw, "damper", "mass_ratio", None)
    if (table, key) == ("plate", "mesh"):
        return _with(_with(raw, "plate", "length", None), "plate", "width", None)
    return raw


def _bent() -> Iterator[tuple[str, Case]]:
    for path, values in BENT.items():
        table, _, key = path.rpartition(".")
        for what, value in values.items():
            raw = _right("paper") if what == "with a plate" else _home(table, key)
            named = key if not table else key_name([table, key])
            if path == "plate.length" and what == "shorter than thick":
                named = "[plate] thickness"
            if path == "plate.thickness" and what == "a table":  # where it varies it is one
                named = "[plate] thickness.a"
            yield f"{path} {what}", Case(_text(_with(raw, table, key, value)), named)


def _misspelt() -> Iterator[tuple[str, Case]]:
    for name, table in _tables():
        for key in table.model_fields:
            raw = _home(name, key)
            wrong = key[:-2] + key[-1] + key[-2] if len(key) > 2 else key + key
            value = raw.get(name, {}).get(key, "1")
            bent = _with(_with(raw, name, key, None), name, wrong, value)
            if wrong != key:
                yield f"misspelt {name}.{key}", Case(_text(bent), f"[{name}] {wrong}", f"did you mean '{key}'?")


def _missing() -> Iterator[tuple[str, Case]]:
    for shipped in ("paper", "structure"):
        raw = _right(shipped)
        for name, table in _tables():
            for key, field in table.model_fields.items():
                if key in raw.get(name, {}) and (field.is_required() or (name, key) in NEEDED[shipped]):
                    bent = _with(raw, name, key, None)
                    yield f"{shipped} without {name}.{key}", Case(_text(bent), f"[{name}] {key}", "missing")


NEEDED = {"paper": {("plate", "length"), ("plate", "width")}, "structure": {("rotor", "radius")}}
"""Keys that can be left out elsewhere, but not in these scenes."""


def _whole_tables() -> Iterator[tuple[str, Case]]:
    for shipped in ("paper", "structure"):
        raw = _right(shipped)
        for name in raw:
            if not name:
                continue
            rest = {table: keys for table, keys in raw.items() if table != name}
            if name not in ("effects", "excitation", "accuracy", "release"):
                # Without its structure a scene is taken for one of a plate that is not there.
                key = "[plate]" if name == "structure" else f"[{name}]"
                yield f"{shipped} without [{name}]", Case(_text(rest), key, "missing")
            for what, value in (("a number", "1"), ("text", '"x"'), ("a list", "[1]"), ("true", "true")):
                bent = {"": raw[""] | {name: value}} | {t: k for t, k in rest.items() if t}
                yield f"{shipped}: {name} is {what}", Case(_text(bent), f"[{name}]", "expected a table")
            array = _text(raw).replace(f"[{name}]\n", f"[[{name}]]\n")
            yield f"{shipped}: {name} in double brackets", Case(array, f"[{name}]", "expected a table")
            swapped = name[:-2] + name[-1] + name[-2]
            misspelt = _text(raw).replace(f"[{name}]\n", f"[{swapped}]\n")
            yield f"{shipped}: [{swapped}]", Case(misspelt, f"[{swapped}]", f"did you mean '{name}'?")


def _combined() -> Iterator[tuple[str, Case]]:
    paper, structure = _right("paper"), _right("structure")
    both = paper | {"structure": structure["structure"]}
    yield "a plate and a structure", Case(_text(both), "[plate]", "leave one out")
    yield (
        "a material for a structure",
        Case(_text(structure | {"material": paper["material"]}), "[material]", "leave one out"),
    )
    yield "hub radius of a structure", Case(_text(_with(structure, "rotor", "hub_radius", "1.0")), "[rotor] hub_radius")
    yield "stagger of a structure", Case(_text(_with(structure, "rotor", "stagger", '"1 deg"')), "[rotor] stagger")
    yield "place on a structure", Case(_text(_with(structure, "damper", "at", "[0.1, 0]")), "[damper] at")
    yield "two masses", Case(_text(_with(paper, "damper", "mass", '"1 g"')), "[damper] mass_ratio", "leave one out")
    yield "no mass", Case(_text(_with(paper, "damper", "mass_ratio", None)), "[damper] mass_ratio")
    yield "a mesh and a length", Case(_text(_with(paper, "plate", "mesh", '"a.msh"')), "[plate] length", "leave")
    for key in ("length", "speeds", "radius", "cycles", "friction"):
        bent = {"": paper[""] | {key: "1"}} | {name: keys for name, keys in paper.items() if name}
        yield f"{key} outside its table", Case(_text(bent), key, "belongs in [")
    yield "a table below a value", Case("title.a = 1\n" + _text({t: k for t, k in paper.items() if t}), "title")
    yield (
        "a key below a key",
        Case(
            _text(_with(paper, "plate", "length", '{ value = 20, unit = "cm" }')), "[plate] length", "expected a length"
        ),
    )
    yield (
        "deeply below",
        Case(
            _text(_with(paper, "plate", "length", None)).replace(
                "[material]", "length" + ".a" * 3000 + " = 1\n[material]"
            ),
            "[plate] length",
        ),
    )
    long = "x" * 5000
    yield "a key of 5000 letters", Case(_text(_with(paper, "plate", long, "1")), f"[plate] {'x' * 50}")
    yield "a value of 5000 letters", Case(_text(_with(paper, "plate", "length", f'"{long}"')), "[plate] length")
    yield "a key on two lines", Case(_text(_with(paper, "plate", '"a\\nb"', "1")), "[plate] a b")


CASES = {name: case for make in (_bent, _misspelt, _missing, _whole_tables, _combined) for name, case in make()}
GROUPS = sorted({name.split()[0] for name in CASES})
"""Cases by the first word of their names: a key's are tried together."""


def test_every_key_is_bent() -> None:
    keys = {f"{name}.{key}" for name, table in _tables() for key in table.model_fields}
    assert set(BENT) - {"title"} == keys
    assert len(CASES) >= 200


@pytest.mark.parametrize("group", GROUPS)
def test_malformed(group: str, spindamp: Command, tmp_path: Path) -> None:
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
