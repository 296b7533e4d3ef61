"""The documentation: its examples run, the tour works word for word, the reference names every key."""

import ast
import importlib.util
import json
import re
import shlex
import sys
import tomllib
from pathlib import Path

import pytest

from tests.workflows.conftest import measured_quickly
from workflows.cli.main import main
from workflows.report import figures, mode_viewer
from workflows.solve import damper

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
EXAMPLES = sorted((DOCS / "examples").glob("plot_*.py"))


@pytest.fixture(autouse=True)
def _undrawn(monkeypatch):
    """Reports without their figures, which are not looked at."""
    monkeypatch.setattr(figures, "report", lambda _: dict.fromkeys(figures.SHOWN, ""))


def test_examples_assert_what_they_show():
    """That they run is seen where the documentation is built, which ends at the first that fails."""
    for path in EXAMPLES:
        nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        assert any(isinstance(node, ast.Assert) for node in nodes), path.name


def said(line, capsys):
    """What a command prints."""
    assert main(shlex.split(line)[1:]) == 0, (line, capsys.readouterr().err)
    return capsys.readouterr().out


def test_the_tour_works_word_for_word(tmp_path, monkeypatch, capsys):
    text = (DOCS / "tour.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(mode_viewer, "screen_exists", lambda: False)
    (scene,) = re.findall(r"```toml\n(.*?)```", text, flags=re.S)
    (tmp_path / "mine.toml").write_text(scene, encoding="utf-8")
    (tmp_path / "meshes").symlink_to(ROOT / "meshes")
    lines = [line for block in re.findall(r"```\n(spindamp .*?)```", text, flags=re.S) for line in block.splitlines()]
    assert len(lines) >= 4
    printed = {line: said(line, capsys) for line in lines}
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert f"```toml\n{scene}```" in readme
    (shown,) = re.findall(r"```\n(My blade: .*?)```", readme, flags=re.S)
    (words, digits), (own_words, own_digits) = map(without_chaos, (shown, printed["spindamp run mine.toml"]))
    assert words == own_words
    assert digits == pytest.approx(own_digits, rel=0.03), "chaos moves the end of a range by one in its third digit"
    (tmp_path / "mine.toml").write_text(scene.replace("length", "lenght"), encoding="utf-8")
    assert main(["check", "mine.toml"]) == 2
    assert "did you mean 'length'?" in capsys.readouterr().err
    (tmp_path / "mine.toml").write_text(scene, encoding="utf-8")
    monkeypatch.setattr(damper, "damping_curve", measured_quickly)
    (code,) = re.findall(r"```python\n(.*?)```", text, flags=re.S)
    exec(compile(code, "tour.md", "exec"), {"__name__": "__main__"})
    assert (tmp_path / "campbell.png").is_file()


def test_the_table_of_mistakes(tmp_path, monkeypatch, capsys):
    """Each example gives the message beside it, and nothing else."""
    (scene,) = re.findall(r"```toml\n(.*?)```", (DOCS / "tour.md").read_text(encoding="utf-8"), flags=re.S)
    rows = re.findall(r"^\| .* \| `(.*)` \| (.*) \|$", (DOCS / "guide" / "troubles.md").read_text("utf-8"), flags=re.M)
    assert len(rows) >= 20
    monkeypatch.chdir(tmp_path)
    for name in ("blade.bdf", "blade.step"):
        (tmp_path / name).touch()
    for example, message in rows:
        text, command = scene, example
        if example.startswith("["):
            table, line = example.split(" ", 1)
            command, key = "spindamp check mine.toml", line.split(" = ")[0]
            head, _, rest = text.partition(f"{table}\n")
            body, gap, others = rest.partition("\n\n")
            kept = [other for other in body.splitlines() if not other.startswith(f"{key} = ")]
            text = head + "\n".join([table, line, *kept]) + gap + others
        (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
        assert main(shlex.split(command)[1:]) == 2, example
        printed = capsys.readouterr()
        assert (printed.out, printed.err) == ("", f"spindamp: {message}\n")


def test_the_page_on_known_modes_works_word_for_word(tmp_path, monkeypatch, capsys):
    """The measured blade, whose writer needs NumPy alone; M2 is 1 over the square of the shape at its place."""
    text = (DOCS / "guide" / "modes.md").read_text(encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    (scene,) = re.findall(r"```toml\n(.*?)```", text, flags=re.S)
    (tmp_path / "mine.toml").write_text(scene, encoding="utf-8")
    codes = re.findall(r"```python\n(.*?)```", text, flags=re.S)
    for code in codes:
        compile(code, "modes.md", "exec")
    (measured,) = (code for code in codes if "import" in code and code.count("import") == 1)
    exec(measured, {"__name__": "__main__"})
    for line in re.findall(r"^spindamp .*mine.toml$", text, flags=re.M):
        last = said(line, capsys)
        if " check " in line:
            mass = float(re.search(r"^# +1 +310 +flap +(\S+)", last, re.M)[1])
            assert abs(mass - 1e3 / 2.27**2) < 0.02 * mass
    assert "the ball adds an equivalent damping ratio" in " ".join(last.split())


def test_the_reference_of_scenes_names_every_key():
    spec = importlib.util.spec_from_file_location("reference_of_scenes", DOCS / "reference.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    page = module.page()
    schema = json.loads((ROOT / "workflows" / "scene.schema.json").read_text(encoding="utf-8"))
    for name, key in schema["properties"].items():
        assert f"`[{name}]`" in page or f"`{name}`" in page, key
    for table in schema["$defs"].values():
        for name in table.get("properties", {}):
            assert f"| `{name}` |" in page
    rows = [line for line in page.splitlines() if line.startswith("|")]
    assert all(len(re.findall(r"(?<!\\)\|", row)) == 5 for row in rows), "no cell breaks its table"


def without_chaos(text):
    """Words and numbers of a run up to its table, whose last columns are chaotic as a ball bounces."""
    head, rows = text.split("\n\n  rpm", 1)
    table = [re.split(r"\s{2,}", row)[:3] for row in rows.split("\n*")[0].splitlines()]
    plain = re.sub(r"(?<=\d) (?=\d{3})", "", " ".join([*head.split(), *(cell for row in table for cell in row)]))
    return re.sub(r"\d+(\.\d+)?", "#", plain).split(), [float(each) for each in re.findall(r"\d+(?:\.\d+)?", plain)]


def test_links_inside_the_documentation_resolve():
    for page in [*DOCS.glob("*.md"), *DOCS.glob("guide/*.md"), ROOT / "README.md"]:
        text = page.read_text(encoding="utf-8")
        for target in re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", text) + re.findall(r'src="([^"]+)"', text):
            name = target.replace("questions/index", "examples/README.txt").replace("questions/", "examples/")
            found = [page.parent / name, page.parent / f"{name}.md", page.parent / f"{name}.py"]
            assert any(path.exists() for path in found), (page.name, target)


ANSWERS = tomllib.loads(Path(__file__).with_name("architecture.toml").read_text(encoding="utf-8"))


def test_the_page_of_hard_cases_names_tests_and_all_that_are_hard_cases():
    named = re.findall(r"`(\S+)::(\w+)` \|$", (DOCS / "hard_cases.md").read_text(encoding="utf-8"), flags=re.M)
    defined = {
        (path.relative_to(ROOT).as_posix(), node.name)
        for path in {ROOT / file for file, _ in named} | set((ROOT / "tests" / "hard_cases").glob("test_*.py"))
        for node in ast.parse(path.read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")
    }
    assert len(named) == len(set(named)) > 50
    assert set(named) <= defined
    assert {case for case in defined if "hard_cases" in case[0]} <= set(named)


def rows_of_architecture():
    lines = (DOCS / "architecture.md").read_text(encoding="utf-8").splitlines()
    return dict(line.strip("| ").split(" | ", 1) for line in lines if line.startswith("| ") and "?" in line)


@pytest.mark.parametrize("question", ANSWERS)
def test_a_newcomer_finds_it_in_one_try(question):
    named = {path.relative_to(ROOT).as_posix() for path in _named(rows_of_architecture()[question])}
    for path, text in ANSWERS[question]:
        assert path in named
        assert text in (ROOT / path).read_text(encoding="utf-8"), path


def test_every_path_that_the_architecture_names_exists():
    for page in (DOCS / "architecture.md", ROOT / "CONTRIBUTING.md"):
        text = page.read_text(encoding="utf-8")
        for path in re.findall(r"`((?:fem|damper|workflows|tests)/[\w/.]+)`", text):
            assert _there(path) is not None, path
        for name in re.findall(r"`(\w+\.py)`", text):
            assert any(
                path
                for room in ("", "fem", "damper", "workflows", "tests")
                for path in (ROOT / room).glob(f"**/{name}" if room else name)
            ), name
    for question, places in rows_of_architecture().items():
        assert list(_named(places)), question


def _named(places):
    """Files that an answer names; a name without a folder is in the one named last before it, if it is a file."""
    folder = None
    for name in re.findall(r"[`(]([\w/.]+)[`)]", places):
        path = _there(name.removeprefix("../")) if "/" in name else _there(f"{folder}/{name}")
        if path is None:
            assert "/" not in name or name.endswith(".json"), name
            assert not name.endswith(".py"), name
            continue
        folder = (path if path.is_dir() else path.parent).relative_to(ROOT)
        yield path


def _there(name):
    return next((path for path in (ROOT / name, ROOT / f"{name}.py") if path.exists()), None)
