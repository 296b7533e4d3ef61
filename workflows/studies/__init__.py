"""More than a run: what accuracy and effects cost, and the paper claim by claim.

May import every room but cli.
"""
