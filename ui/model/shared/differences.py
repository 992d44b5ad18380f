"""Differences between a text on disk and its edited version."""

import difflib


def differences(saved: str, edited: str, name: str = "") -> tuple[str, ...]:
    """Return the output of `diff -u` for two texts; empty if the texts are equal."""
    before = f"{name} on disk".lstrip()
    after = f"{name} to be written".lstrip()
    return tuple(difflib.unified_diff(saved.splitlines(), edited.splitlines(), before, after, lineterm=""))
