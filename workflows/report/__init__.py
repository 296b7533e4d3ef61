"""The numbers for people: verdict and remarks in words, page, figures, pictures, text, windows, and their writing.

May import io and what that may.
"""
