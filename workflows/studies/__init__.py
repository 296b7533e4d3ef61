"""More than a run: what accuracy and effects cost, the paper claim by claim, and any keys of a scene varied.

May import every room but cli.
"""
