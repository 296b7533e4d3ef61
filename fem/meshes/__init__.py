"""Planforms and their meshes: rectangles, files, finer and finer ones, where a point lies, thickness over them.

Knows nothing of plates; imports of fem `linalg` alone.
"""
