"""A template set while it is edited."""
