"""What is given: material, plate, root, rotor.

May import meshes.
"""
