"""The ball's path in a report: the motion that was computed, every event at its place, and a player that shows it."""

import base64
import json

import numpy as np
import pytest

import spindamp
from damper import Mode, ringdown, sample
from damper.state import GRIP, HIT, RELEASE, REVERSAL, RUB, START
from tests.damper.scenes import paper
from tests.workflows.browser import needs_chromium
from tests.workflows.conftest import changed
from workflows.report import figures
from workflows.report import page as ball_player
from workflows.solve import damper as ball_path

START_JS = "const figure = document.querySelector('figure.player'), form = figure.querySelector('form');"
START_JS += "const box = figure.querySelector('.player-box'), says = figure.querySelector('output');"
START_JS += "const svg = [...box.querySelectorAll('svg')].find(svg => svg.getBoundingClientRect().width > 0);"


@pytest.fixture(scope="module")
def results(finished):
    return spindamp.load_results(finished)


@pytest.fixture(scope="module")
def path(results):
    (found,) = [p.damper.path for p in results.speeds if p.damper is not None and p.damper.path is not None]
    return found


def a_damper(**changes):
    given = {"stiffness": (4e6, 4e6), "cavity": (4e-3, 3e-3), "damping_ratio": 0.01}
    return paper(100, mass_ratio=0.01, **given | changes)


def hits(path):
    return np.flatnonzero([kind == "hit" for kind in path.kind])


@pytest.mark.parametrize("changes", [{}, {"floor_tilt": (20.0, 0.0)}, {"floor_radius": (0.05, 0.05)}])
def test_a_hit_is_where_the_ball_touches_its_wall(changes):
    damper = a_damper(**changes)
    found = ball_path.ball_path(ringdown(damper, (5e-3, 2e-3), keep_events=True))
    half = np.array(damper.cavity) / 2 - damper.ball_radius
    touched = hits(found)
    assert len(touched) > 8
    assert np.abs(found.ball[found.at[touched], found.axis[touched]]) == pytest.approx(
        half[found.axis[touched]], rel=1e-9
    )
    assert (np.abs(found.ball) <= half * (1 + 1e-9)).all()


def test_the_path_holds_every_event_in_its_time():
    damper = a_damper()
    motion = ringdown(damper, (5e-3, 2e-3), keep_events=True)
    found, rows = ball_path.ball_path(motion), motion.rows
    period = 2 * np.pi / damper.stuck_frequency
    assert found.t[-1] - found.t[0] == pytest.approx(ball_path.CYCLES * period)
    inside = rows[(rows["time"] >= found.t[0]) & (rows["time"] <= found.t[-1])]
    assert (found.t[found.at] == inside["time"]).all()
    assert (found.axis == inside["axis"]).all()
    numbers = {"release": RELEASE, "start": START, "reversal": REVERSAL, "hit": HIT, "rub": RUB, "grip": GRIP}
    assert [numbers[kind] for kind in found.kind] == inside["kind"].tolist()


def test_straight_lines_between_its_times_are_the_motion():
    """Off the times that are kept, against the exact motion; a swing a sin wt departs by a (w dt)² / 8 at most."""
    damper = a_damper()
    motion = ringdown(damper, (5e-3, 2e-3), keep_events=True)
    found = ball_path.ball_path(motion)
    between = np.sort(np.random.default_rng(3).uniform(found.t[0], found.t[-1], 2000))
    exact = sample(motion, between)
    for kept, there, bound in (
        (found.structure, exact.displacement, 5e-3 * (2 * np.pi / 60) ** 2 / 8),
        (found.ball, exact.relative_position, 5e-3 * (2 * np.pi / 60) ** 2 / 8 + 1e3 * (np.pi / 2000 / 30) ** 2 / 8),
    ):
        drawn = np.column_stack([np.interp(between, found.t, kept[:, i]) for i in range(2)])
        assert np.abs(drawn - there).max() <= 1.01 * bound


def test_a_ball_at_rest_is_carried_along():
    """Where it does not move in the cavity its place there does not change, and it moves elsewhere."""
    found = ball_path.ball_path(ringdown(a_damper(), (5e-3, 0.0), keep_events=True))
    step = np.abs(np.diff(found.ball, axis=0))
    still = found.regime[:-1] == 0
    assert still.any()
    assert step[still].max() <= 1e-15
    assert (step[~still] > 0).mean() > 0.99


def test_a_ball_that_never_moves_has_no_path():
    assert ball_path.ball_path(ringdown(a_damper(), (1e-6, 0.0), keep_events=True)) is None


def test_a_late_start_is_not_waited_for():
    """In a beat of two modes the cavity swells from nothing, and the ball rests for many cycles before it sets off."""
    modes = (Mode(1.0, 4e6, (1.0, 0.0), (0.0, 0.0)), Mode(1.0, 4.2e6, (1.0, 0.0), (0.0, 0.0)))
    damper = a_damper(modes=modes, damping_ratio=0.0, centrifugal_acceleration=4e4)
    motion = ringdown(damper, (0.0, 0.0), amplitudes=(1e-3, -1e-3), keep_events=True, max_cycles=200)
    found = ball_path.ball_path(motion)
    assert found.t[0] > 2 * np.pi / damper.stuck_frequency
    first = next(k for k, kind in enumerate(found.kind) if kind == "start")
    assert found.t[found.at[first]] - found.t[0] == pytest.approx(np.pi / 2 / damper.stuck_frequency)


def test_a_chattering_ball_does_not_flood_the_page(monkeypatch):
    monkeypatch.setattr(ball_path, "EVENTS_AT_MOST", 40)
    found = ball_path.ball_path(ringdown(a_damper(), (5e-3, 2e-3), keep_events=True))
    assert len(found.at) == 40
    assert found.at[-1] == len(found.t) - 1


def test_what_a_page_gets_is_the_path(results, path):
    data = json.loads(ball_player.data(results))
    t = np.frombuffer(base64.b64decode(data["t"]), "<f4") + data["begin"]
    assert t == pytest.approx(1e3 * path.t, rel=1e-6, abs=1e-6)
    for name, motion in (("ball", path.ball), ("structure", path.structure)):
        raw = np.frombuffer(base64.b64decode(data[name]["places"]), "<i2").reshape(2, -1)
        found = raw.T * data[name]["largest"] / 32767
        assert np.abs(found - 1e3 * motion).max() <= 0.51 * data[name]["largest"] / 32767
    assert sum(words.startswith("hits") for _, words, _ in data["events"]) == path.kind.count("hit")
    assert len(data["regime"]) == len(path.t)


def test_the_curves_drawn_are_files_too(finished, path):
    table = np.loadtxt(finished / "ball_x_10000rpm.csv", delimiter=",", skiprows=1)
    assert table[:, 0] == pytest.approx(path.t, rel=1e-9, abs=1e-12)
    assert table[:, 1] == pytest.approx(path.ball[:, 0], rel=1e-9)
    assert (finished / "displacement_y_10000rpm.csv").is_file()


def test_the_still_picture_marks_the_walls_that_were_hit(finished, results, path):
    page = (finished / "report.html").read_text(encoding="utf-8")
    assert page.count("The ball’s path in its cavity at 10\u2009000 rpm") == 1
    damper = results.scene.damper
    places = figures.contacts(path, damper.radius)
    axes = np.unique(path.axis[hits(path)])
    assert set(np.round(np.abs(places[:, axes[0]]), 12)) == {damper.cavity[axes[0]] / 2}


@pytest.mark.usefixtures("quickly")
def test_without_a_damper_that_moves_there_is_no_player(paper, spindamp, tmp_path):
    cheap = {"plate__theory": "kirchhoff", "accuracy__frequency": 0.02, "rotor__modes": 1, "excitation": None}
    scene = changed(paper, release__displacement=["1 um", "0 mm"], rotor__speeds=["10000 rpm"], **cheap)
    assert spindamp("run", scene, "--out", "out").status == 0
    page = (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    assert 'id="path"' not in page
    assert "does not move in this ring-down" in page


@needs_chromium
def test_the_ball_goes_from_event_to_event(standing, path):
    script = """
    const ball = svg.querySelector('.ball'), frame = JSON.parse(svg.dataset.axes)[0], found = [];
    const scale = (frame.box[1] - frame.box[0]) / (frame.x[1] - frame.x[0]);
    const place = () => [(ball.getAttribute('cx') - frame.box[0]) / scale + frame.x[0],
                         frame.y[1] - (ball.getAttribute('cy') - frame.box[2]) / scale];
    const begun = place();
    for (let k = 0; k < 40; k++) { form.on.click(); found.push([figure.player.at(), ...place(), says.textContent]); }
    form.back.click();
    const back = figure.player.at();
    box.dispatchEvent(new KeyboardEvent('keydown', { key: 'Home' }));
    return { radius: ball.getAttribute('r') / scale, begun, found, back,
             live: figure.classList.contains('live'), hidden: form.hidden };
    """
    found = standing.returned(START_JS + script)
    assert found["live"]
    assert not found["hidden"]
    assert found["radius"] == pytest.approx(1.0, rel=1e-3), "to scale"
    assert found["begun"] == pytest.approx([0.0, 0.0], abs=1e-3)
    told = ball_player.events(path)
    moments = np.unique([path.t[at] for at, _, _ in told])
    moments = moments[moments > path.t[0]]
    for (at, x, y, said), moment in zip(found["found"], moments, strict=False):
        assert at == pytest.approx(1e3 * (moment - path.t[0]), rel=1e-5)
        k = int(np.searchsorted(path.t, moment))
        assert (x, y) == pytest.approx(tuple(1e3 * path.ball[k]), abs=2e-4)
        past = sum(words.startswith("hits") for when, words, _ in told if path.t[when] <= moment)
        assert f"{past} wall hit" in said
    assert found["back"] == pytest.approx(found["found"][-2][0])


@needs_chromium
def test_it_plays_pauses_and_listens_to_keys(standing):
    script = """
    const at = () => figure.player.at(), press = key => box.dispatchEvent(new KeyboardEvent('keydown', { key }));
    press(' '); const playing = form.play.textContent, pressed = form.play.getAttribute('aria-pressed');
    const now = performance.now(); figure.player.frame(now + 50); figure.player.frame(now + 150); const played = at();
    press(' '); const paused = form.play.textContent;
    press('Home'); const home = at(); press('ArrowRight'); const step = at(); press('ArrowLeft'); const back = at();
    press('ArrowDown'); const event = at(); press('End'); const end = at();
    form.play.click(); const again = at(); form.play.click();
    form.time.value = 0.5; form.time.dispatchEvent(new Event('input')); const half = at();
    const cursor = svg.querySelector('.cursor'), frame = JSON.parse(svg.dataset.axes)[1];
    return { playing, pressed, played, paused, home, step, back, event, end, again, half,
             first: figure.player.moments.find(t => t > 1e-9),
             last: figure.player.data.t.at(-1), cycle: 1 / figure.player.data.frequency,
             cursor: (cursor.getAttribute('x1') - frame.box[0]) / (frame.box[1] - frame.box[0]),
             spoken: form.time.getAttribute('aria-valuetext'), said: says.textContent };
    """
    found = standing.returned(START_JS + script)
    assert (found["playing"], found["pressed"], found["paused"]) == ("pause", "true", "play")
    assert 0 < found["played"] < found["cycle"]
    assert found["home"] == found["back"] == found["again"] == 0
    assert found["step"] == pytest.approx(found["cycle"] / 60)
    assert found["event"] == pytest.approx(found["first"])
    assert found["end"] == pytest.approx(found["last"])
    assert found["half"] == pytest.approx(found["last"] / 2)
    assert found["cursor"] == pytest.approx(0.5, abs=1e-3)
    assert "cycle 4.0" in found["spoken"]
    assert found["spoken"].split(", ")[0] in found["said"]
