"""Plate theories: which fields move a point of the plate, their strains, their elements.

May import meshes and plate.
"""
