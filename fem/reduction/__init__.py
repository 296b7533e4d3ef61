"""The plate as the damper feels it: one mass on one spring.

May import sweep and what that may.
"""
