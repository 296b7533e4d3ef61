"""Sparse factors and eigenvalues, of any matrices.

Knows no plate; imports nothing of fem.
"""
