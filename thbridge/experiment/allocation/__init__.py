"""Allocation of people to conditions and orders: Latin squares, blocks dealt by a seed, quotas of valid runs."""
