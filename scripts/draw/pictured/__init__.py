"""The states of the windows that `windows.py` takes pictures of."""
