"""Random ring-downs and plates by the thousand, each of which has to keep what physics keeps.

    python -m tests.soak --ringdowns 100000 --plates 1000 --seed 0 [--out DIR]

A scene that fails is written into DIR, to be run again with `spindamp run`.
"""
