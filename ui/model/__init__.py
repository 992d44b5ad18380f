"""View models of all windows: contents of windows, and acts of people in them, as plain values without Qt."""
