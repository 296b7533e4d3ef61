"""Folders that are replaced whole or not at all, and signals that end a command.

May import no other room.
"""
