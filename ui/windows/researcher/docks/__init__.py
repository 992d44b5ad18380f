"""Docks around the researcher's map: robots, displays, plots, arguments, lists, topics, playback, and wizard."""
