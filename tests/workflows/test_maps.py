"""Maps of studies: what they draw, where there is nothing to draw, and what they say of it."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr

from workflows.studies.sweep import evaluate, report
from workflows.studies.sweep.report import HEADLINE

RPM = (3000.0, 5000.0, 7000.0, 9000.0)


@pytest.fixture
def data():
    """Damping that grows with mass and clearance, less at each speed, and none from the third on or in a corner."""
    mass, clearance = np.geomspace(1e-3, 1e-2, 6), np.geomspace(1e-4, 4e-3, 5)
    share = np.array([1.0, 0.4, 0.0, 0.0])
    ratio = mass[:, None, None] * (clearance[:, None] / 4e-3) * share
    ratio[:2, 0, :] = 0.0
    omega = np.array(RPM) * math.pi / 30
    dims = ("damper.mass_ratio", "damper.clearance", "rotor.speeds")
    found = {name: (dims, np.full(ratio.shape, np.nan)) for name in evaluate.empty(1).dtype.names if name != "reason"}
    found |= {HEADLINE: (dims, ratio), "cutoff": (dims, np.broadcast_to(1e-9 * omega**2, ratio.shape))}
    coords = dict(zip(dims, (mass, clearance, omega), strict=True)) | {"rpm": ("rotor.speeds", list(RPM))}
    data = xr.Dataset(found, coords)
    data["damper.clearance"].attrs["units"] = "m"
    data["rotor.speeds"].attrs["units"] = "rad/s"
    return data


def test_panels_are_of_speeds_at_which_a_ball_works(data):
    assert report.panels(data, ("damper.mass_ratio", "damper.clearance")) == ("rotor.speeds", [0, 1])
    (picture,) = report.draw(data)
    assert "3000 rpm" in picture.svg
    assert "5000 rpm" in picture.svg
    assert "7000 rpm" not in picture.svg
    assert "Nothing to draw at 7000 rpm to 9000 rpm" in picture.caption
    assert "The load holds the ball at rest below 0.099 mm at 3000 rpm, 0.27 mm at 5000 rpm." in picture.caption
    assert "It lies at an end of mass ratio and clearance" in picture.caption


def test_what_takes_nothing_is_hatched_and_named(data):
    (picture,) = report.draw(data)
    assert "nothing, or no verdict" in picture.svg
    data[HEADLINE] = data[HEADLINE].where(data[HEADLINE] > 0, 1e-5)
    (full,) = report.draw(data)
    assert "nothing, or no verdict" not in full.svg


def test_a_cut_off_that_varies_has_a_map(data):
    data["cutoff"] = data["cutoff"] * (1 + 1e3 * data["damper.clearance"])
    assert len(report.draw(data)) == 2
