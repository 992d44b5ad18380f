"""Options of the text protocol."""
