"""The numbers for programs: JSON, netCDF, CSV, VTU, where they come from.

May import solve and what those may.
"""
