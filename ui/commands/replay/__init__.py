"""`thbridge replay`."""
