"""Planforms and their meshes: rectangles, files, finer and finer ones, where a point lies.

Knows nothing of plates; imports nothing of fem.
"""
