"""`spindamp response`: what the damper does where engine orders cross the structure's modes.

`crossings` finds these, `study` follows the steady states through them, `told` says what was found, `plots` and `page`
show it, `files` hold it.
"""
