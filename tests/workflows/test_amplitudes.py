"""What the answer says of the amplitudes at which a ball does what it can, and of how well they are known."""

from __future__ import annotations

import math
import re

import pytest

import workflows
from tests.workflows.conftest import KNOWN
from workflows.report.verdict import answer, known_within
from workflows.solve.results import Results

pytestmark = pytest.mark.usefixtures("undrawn")

HALF_GAP = 0.25e-3


def lively(restitution: float) -> Results:
    """A ball that next to nothing holds, at one speed."""
    changes = {"restitution": restitution, "rolling_friction": "0.00001 mm"}
    rotor = KNOWN["rotor"] | {"speeds": ["17500 rpm"]}
    return workflows.run(KNOWN | {"rotor": rotor, "damper": KNOWN["damper"] | changes})


def widest(amplitude: float) -> float:
    """Furthest way in the cavity of a ball that rolls freely from rest, while the floor's amplitude grows to that [m].

    The floor moves as A(t) sin t, A growing in 100 periods; the ball relatively to it by s'' = -(5/7) u'', in small
    steps by the midpoint rule, whose error is far below a percent.
    """
    steps, way, speed, far = 400, 0.0, 0.0, 0.0
    dt, span = 2 * math.pi / steps, 200 * math.pi

    def push(t: float) -> float:
        grown = amplitude / span
        return -grown * t * math.sin(t) + 2 * grown * math.cos(t)

    for k in range(100 * steps):
        half = speed - 5 / 7 * push(k * dt) * dt / 2
        way += half * dt
        speed = half - 5 / 7 * push((k + 1) * dt) * dt / 2
        far = max(far, abs(way))
    return far


def test_a_ball_at_rest_meets_no_wall_where_one_that_bounces_goes_on() -> None:
    found = lively(0.7)
    told = " ".join(answer(found).sentences)
    said = re.search(r"one at rest meets no wall at 17500 rpm below ([\d.]+) mm, and takes less\.", told)
    assert said is not None
    below = 1e-3 * float(said[1])
    assert found.speeds[0].working.half[0] < 0.8 * below
    assert widest(0.95 * below) < HALF_GAP < widest(1.05 * below)


def test_a_peak_that_the_pace_moves_is_said_to_be_known_less_well() -> None:
    found = lively(0.99)
    error = found.speeds[0].working.error
    assert error > 0.05
    assert f"(known within {100 * error:.2g} %): it takes" in answer(found).sentences[0]
    assert known_within(lively(0.6).speeds[0]) == ""
