"""What is kept of a driven motion: its envelope cycle by cycle, in batches, and where it was at the end of a cycle.

A cycle is one of the force. Its amplitude is half of what a displacement, the probe, goes through in it.
"""

from __future__ import annotations

from damper.records import record
from damper.system import LINEAR, MODES

BATCHES = 32
"""Parts of a window whose means tell the statistical error."""

GOES_ON, LOCKED, PERIODIC, APERIODIC, UNSETTLED, TIRED = 0, 1, 2, 3, 4, 5
"""Verdicts: none yet; three kinds of steady states; not settled within the cycles or the events allowed."""

_N = MODES + 2

TALLY = record(
    ("cycles", "f8"),
    ("least", "f8"),
    ("greatest", "f8"),
    ("total", "f8"),  # of the amplitudes of cycles
    ("squares", "f8"),
    ("work", "f8"),  # put in since the start, at the beginning of the tally [J]
    ("lost", "f8"),
    ("stored", "f8"),  # energy of structure and ball then [J]
    ("impacts", "f8"),
)
"""Sums over cycles; after its end `work`, `lost`, `stored` and `impacts` are what was gained in it."""

TRACE = record(
    ("probe", "f8", _N),  # displacement = probe z
    ("still", "f8", (2, _N)),  # z and its rate at the start of a cycle if the ball is never to move
    ("drive", "f8", 2),  # largest drive of a stuck ball then [m/s^2]
    ("scale", "f8", _N),  # by which differences of z are measured; rates by that times the frequency
    ("period", "f8"),  # of the force
    ("cycles", "i8"),  # so far
    ("patience", "i8"),  # cycles that the structure's own motion takes to be forgotten
    ("high", "f8"),  # extremes of the probe in this cycle
    ("low", "f8"),
    ("away", "f8", (2, _N)),  # to work on: z and its rate less those of `still`
    ("reference", "f8", (2, _N)),  # z and its rate at the start of a batch
    ("spin", "f8", 2),
    ("near", "f8", 2),  # least distance from there at later cycles, in the middle and in the last batch of a window
    ("repeats", "i8"),  # after how many cycles, in the last
    ("left", "f8"),  # distance that is left to the orbit which the motion comes to
    ("means", "f8", (3, BATCHES)),  # of amplitude, of power put in and of amplitude squared, batch by batch
    ("error", "f8", 2),  # standard errors of these means over the window
    ("drift", "f8"),  # mean amplitude of the window's second half less that of its first
    ("verdict", "i8"),
)
"""A driven motion on its way to its steady state."""

DRIVEN = record(("run", LINEAR), ("envelope", TRACE), ("window", TALLY), ("last", TALLY))
"""A run under a harmonic force: tallies of the window, and of its last batch."""
