"""The numbers for people: page, figures, pictures, text, and their writing.

May import results, output and what those may.
"""
