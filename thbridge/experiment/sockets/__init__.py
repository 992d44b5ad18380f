"""Markers for other recording programs, sent over the network."""
