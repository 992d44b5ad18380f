"""The commands of `thbridge sweep`."""
