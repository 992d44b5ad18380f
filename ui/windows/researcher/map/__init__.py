"""Overlays of the researcher's map, and the tools that work on it."""
