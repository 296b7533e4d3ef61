"""Any keys of a scene over a grid or a sample: many runs as one study, which survives and may be spread over machines.

`axes` (what is varied), `plan` (points by absolute index, and their scenes), `evaluate` (many points at once:
structures solved once for all dampers on them, the headline numbers in rows), `executor` (who computes), `store`
(what stays, as one data set), `study` (the loop), `sensitivity` (what a scatter does), `report` (summary, page and
pictures).
"""
