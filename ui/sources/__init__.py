"""Data sources of windows: recordings, read in small pieces so that windows stay responsive; without Qt."""
