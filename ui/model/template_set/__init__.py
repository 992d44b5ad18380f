"""A template set in an editor."""
