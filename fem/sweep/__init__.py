"""Modes over many speeds: a reduced basis with a bound on its error, and which mode is which.

May import modes and what those may.
"""
