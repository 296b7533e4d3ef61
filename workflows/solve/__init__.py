"""The stages of a run: what is settled first, plate, damper; what they need of the machine, the records they hand on.

May import effects and scene, `fem` and `damper`.
"""
