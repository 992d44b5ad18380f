"""Differences between a text on disk and the same text as it is edited."""

import difflib


def differences(saved: str, edited: str, name: str = "") -> tuple[str, ...]:
    """Return the lines that differ, with some around them, as `diff -u` has them; none where the texts are the same."""
    before = f"{name} on disk".lstrip()
    after = f"{name} to be written".lstrip()
    return tuple(difflib.unified_diff(saved.splitlines(), edited.splitlines(), before, after, lineterm=""))
