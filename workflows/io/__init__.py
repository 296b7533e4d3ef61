"""Files: results as JSON, netCDF, CSV and VTU, where they come from, and folders that are replaced whole or not at all.

May import solve and what is below it.
"""
