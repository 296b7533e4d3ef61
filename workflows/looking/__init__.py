"""What there is to look at: results, scenes and mesh files, in a window or as a page.

May import the pipeline, report and what those may.
"""
