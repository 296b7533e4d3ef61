"""What the numbers mean: the answer, remarks, what can be trusted, what was assumed.

May import results and what those may.
"""
