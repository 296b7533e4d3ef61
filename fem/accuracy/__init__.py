"""Errors of frequencies, and the mesh and the theory that keep them small.

May import everything of fem.
"""
