"""The matrices of a plate on a rotor, made once for all speeds, and its shapes elsewhere.

May import what is above them in the order of fem: meshes, plate, theory, linalg.
"""
