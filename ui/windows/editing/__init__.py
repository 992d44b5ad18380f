"""Parts of windows in which files are edited."""
