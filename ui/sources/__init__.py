"""Sources of windows: recordings, read in pieces so that no window waits for them; no Qt."""
