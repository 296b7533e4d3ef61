"""Sixty plates against CalculiX: does every frequency keep within the error estimated beside it?

`python -m tests.survey` runs them; `python -m tests.survey.references` makes CalculiX's answers anew.
"""
