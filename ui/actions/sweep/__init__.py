"""The work of the commands of `thbridge sweep`."""
