"""Template set in an editor."""
