"""The commands of `thbridge bag`."""
