"""The stages of a run, plate and damper, what they need of the machine, and the records that they hand on.

May import decisions and scene, `fem` and `damper`.
"""
