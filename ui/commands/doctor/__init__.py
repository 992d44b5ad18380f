"""`thbridge doctor`."""
