"""The programs apart: `thbridge server`, `simr`, `hider`, `tabui`."""
