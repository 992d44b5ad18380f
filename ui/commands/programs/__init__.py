"""Commands that run one program each: `thbridge server`, `simr`, `hider`, `tabui`."""
