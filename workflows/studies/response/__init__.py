"""`spindamp response`: what the damper does where engine orders cross the structure's modes.

`workflows.solve.engine_orders` finds these, `study` follows the steady states through them and holds what was found,
`report` shows it.
"""
