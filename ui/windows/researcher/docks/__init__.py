"""Docks around the researcher's map: robots, displays, plots, lists, playback, wizard."""
