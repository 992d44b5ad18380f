"""Commands of `thbridge maps`."""
