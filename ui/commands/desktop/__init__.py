"""`thbridge desktop`."""
