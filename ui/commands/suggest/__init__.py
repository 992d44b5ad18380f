"""`thbridge suggest`."""
