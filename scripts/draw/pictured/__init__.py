"""States of the windows that `windows.py` draws."""
