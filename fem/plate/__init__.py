"""What is given: material, plate, thickness, root, rotor.

May import meshes.
"""
