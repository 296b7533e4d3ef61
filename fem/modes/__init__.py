"""Modes at one speed, real and complex; their families; the critical speed.

May import statics and what that may.
"""
