"""The commands that run parts of a robot by themselves: `thbridge drive`, `localize`, `plan`, `scan`."""
