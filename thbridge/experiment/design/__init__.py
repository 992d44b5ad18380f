"""The design of an experiment: its file, its conditions, and the steps that a person goes through."""
