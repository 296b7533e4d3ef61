"""The damper that damps best within what a scene's [design] allows.

`space` (what is free, as axes, and what limits it), `asked` (from the table to a space and its goal), `objective`
(designs on the structure, against the limits), `scored` (what they are worth), by one of two goals: `damping` (the
least over a range of amplitudes) or `amplitude` (the greatest at the crossings; `crossed`: a damper there, `balance`:
the short way); `search` (everywhere, then near the best), `holds` (what holds it), `verdict` (how far below the bound,
why none works; `of_damping`, `of_amplitude`, `words`), `designed` (what was found), `study` (the loop), `page`,
`pictures` and `curves`.
"""
