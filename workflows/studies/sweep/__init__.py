"""Any keys of a scene over a grid or a sample: one study that survives and may use many machines.

From what is asked to what is found: `plan` (what is varied, points by absolute index, the scene of each), `evaluate`
(many points at once: structures, dampers, rows of headline numbers), `executor` (who computes), `store` (the data set
on the disk), `study` (the loop), `sensitivity` (percentiles and Sobol' indices), `report` (text, JSON, page).
"""
