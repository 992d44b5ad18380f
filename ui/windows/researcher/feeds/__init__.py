"""Sources of data for the researcher's window: a running session, or a recording."""
