"""The states of the windows that `draw_windows.py` takes pictures of."""
