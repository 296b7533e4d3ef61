"""Runs side by side: `study` (what differs), `report` (text, JSON, CSV, chart, page)."""
