"""The store of an experiment: a log of all events. Its readers detect changed and missing entries."""
