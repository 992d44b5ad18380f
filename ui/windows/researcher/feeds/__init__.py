"""Sources of data for the researcher's window: running sessions and recordings."""
