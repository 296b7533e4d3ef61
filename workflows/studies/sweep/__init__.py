"""Any keys of a scene over a grid or a sample: many runs as one study, which survives and may be spread over machines.

From what is asked to what is found: `keys`, `key_data` and `axes` (what is varied), `plans` (points by absolute index),
`scenes` (the scene of a point), `plates` (structures, solved once for all dampers on them), `placed` (a damper on one),
`quantities` (the headline numbers, in rows), `blocks` (many points at once), `folder` (immutable shards), `crew` (who
computes), `study` (the loop), `table` (one labelled data set), `summary`, `page`, and `pictures` with `map_pictures`,
`labels` and `maps`.
"""
