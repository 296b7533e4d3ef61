"""The state that the load leaves, and the stiffness about it.

May import operators and what those may.
"""
