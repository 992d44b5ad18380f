"""Allocation of people to conditions and orders: Latin squares, seeded random blocks, quotas of valid runs."""
