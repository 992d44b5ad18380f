"""Command line and windows: everything that people touch."""
