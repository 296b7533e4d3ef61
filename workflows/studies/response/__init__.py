"""`spindamp response`: what the damper does where engine orders cross the structure's modes.

`workflows.results.crossings` finds these, `band` says at which speeds they are followed, `driven` how the force drives
which modes there, `study` follows the steady states through them, `peaks`, `told` and `document` say what was found,
`plots` and `page` show it, `files` hold it.
"""
