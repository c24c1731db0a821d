"""The dimensionless contact problem, its solution and what is measured of it."""
