"""What a scene calls for: its effects, its theory, a rule each.

May import effects and scene, and `fem` to look at coarse meshes.
"""
