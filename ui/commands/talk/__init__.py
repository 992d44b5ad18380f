"""`thbridge talk`."""
