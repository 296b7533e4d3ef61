"""The damper that damps best within what a scene's [design] allows.

`space` (what is free, as axes, and what limits it), `objectives` (what designs are worth, by one of two goals: the
least damping over a range of amplitudes, or the greatest amplitude at the crossings), `study` (everywhere, then near
the best), `report` (what was found, what holds it, why none works; page and pictures).
"""
