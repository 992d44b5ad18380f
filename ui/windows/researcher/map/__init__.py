"""Overlays and tools of the researcher's map."""
