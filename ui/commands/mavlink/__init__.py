"""`thbridge mavlink`."""
