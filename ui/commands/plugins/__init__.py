"""`thbridge plugins`."""
