"""Solid blades of any shape, on the meshes that users bring: elements, matrices, equilibria and modes over speeds.

May import what is above them in the order of fem: meshes, plate, theory, linalg, assembly, statics, modes.
"""
