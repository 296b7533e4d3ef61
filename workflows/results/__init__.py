"""The numbers for programs: JSON, netCDF, CSV, VTU, where they come from.

May import findings and what those may.
"""
