"""Commands of `thbridge bag`."""
