"""Markers for other recorders, sent over the network."""
