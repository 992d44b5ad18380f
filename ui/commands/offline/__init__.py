"""Commands that run single parts of a robot: `thbridge drive`, `localize`, `plan`, `scan`."""
