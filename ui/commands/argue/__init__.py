"""`thbridge argue`."""
