"""The damper that damps best within what a scene's [design] allows.

`space` (what is free, as axes, and what limits it), `objective` (what a design is worth), `search` (everywhere, then
near the best), `verdict` (how far below the bound, what holds it, why none works), `study` (the loop), `page` and
`pictures`.
"""
