"""What the researcher's window draws on the map, and the tools that work on it."""
