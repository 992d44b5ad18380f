"""`thbridge docs`."""
