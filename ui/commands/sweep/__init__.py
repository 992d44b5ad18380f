"""Commands of `thbridge sweep`."""
