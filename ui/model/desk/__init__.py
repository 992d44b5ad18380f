"""Researcher's desk during a study with people: the state of all runs, and requests to the host."""
