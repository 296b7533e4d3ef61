"""The stages of a run: what is settled first, structure, damper, limits; what they need of the machine, their records.

May import effects and scene, `fem` and `damper`.
"""
