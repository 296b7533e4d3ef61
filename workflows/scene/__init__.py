"""What a user describes: tables with their checks, units, materials, files, the schema.

May import no other room; `fem` for the meshes of plates.
"""
