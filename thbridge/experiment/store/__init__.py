"""The store of an experiment: a log of all events that detects changed and missing entries."""
