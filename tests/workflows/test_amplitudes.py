"""What the answer says of the amplitudes at which a ball does what it can, and of how well they are known."""

import math
import re

import pytest

import workflows
from tests.workflows.conftest import KNOWN
from workflows.report.verdict import answer

pytestmark = pytest.mark.usefixtures("undrawn")

HALF_GAP = 0.25e-3


def lively(restitution, rolling_friction="0.00001 mm"):
    """A ball that next to nothing holds, at one speed."""
    changes = {"restitution": restitution, "rolling_friction": rolling_friction}
    rotor = KNOWN["rotor"] | {"speeds": ["17500 rpm"]}
    return workflows.run(KNOWN | {"rotor": rotor, "damper": KNOWN["damper"] | changes})


def widest(amplitude):
    """Furthest way in the cavity of a ball that rolls freely from rest, while the floor's amplitude grows to that [m].

    The floor moves as A(t) sin t, A growing in 100 periods; the ball relatively to it by s'' = -(5/7) u'', in small
    steps by the midpoint rule, whose error is far below a percent.
    """
    steps, way, speed, far = 400, 0.0, 0.0, 0.0
    dt, span = 2 * math.pi / steps, 200 * math.pi

    def push(t):
        grown = amplitude / span
        return -grown * t * math.sin(t) + 2 * grown * math.cos(t)

    for k in range(100 * steps):
        half = speed - 5 / 7 * push(k * dt) * dt / 2
        way += half * dt
        speed = half - 5 / 7 * push((k + 1) * dt) * dt / 2
        far = max(far, abs(way))
    return far


def test_a_growing_vibration_is_said_to_do_less_than_one_that_falls():
    """With what the way down has; and up to where a ball that keeps to the middle meets no wall."""
    found = lively(0.7)
    own = found.speeds[0].damping_curve
    assert own.peak < 0.5 * own.from_above.peak
    said = re.search(
        r"may roll or rest without hitting a wall up to ([\d.]+) mm\. As the vibration falls, they keep bouncing"
        r" down to about ([\d.]+) mm and add up to about ([\d.]+) %",
        " ".join(answer(found).sentences),
    )
    rolls, stops, most = map(float, said.groups())
    assert (stops, rolls) == pytest.approx([1e3 * end for end in own.folds], rel=0.05)
    assert most == pytest.approx(100 * own.from_above.peak, rel=0.05)
    assert widest(0.95e-3 * rolls) < HALF_GAP < widest(1.05e-3 * rolls)


def test_a_peak_that_sweeps_show_less_well_is_said_to_be_known_less_well():
    found = lively(0.99, "0.01 mm")
    error = found.speeds[0].damping_curve.error
    assert error > 0.05
    assert f"(±{100 * error:.2g} %), at" in answer(found).sentences[0]
    assert "±" not in " ".join(answer(lively(0.6, "0.1 mm")).sentences)
