"""`thbridge templates`."""
