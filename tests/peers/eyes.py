"""What a screen reader sees of the desktop: run by Debian's Python, which has pyatspi.

Each line `look` at standard input is answered with one line of JSON: every accessible that shows on the screen.
"""

import json
import sys

import pyatspi


def seen(accessible, window, found):
    """Take down an accessible and all in it."""
    states = accessible.getState()
    try:
        box = accessible.queryComponent().getExtents(pyatspi.DESKTOP_COORDS)
    except NotImplementedError:
        box = None
    role = accessible.getRoleName()
    if role in ("frame", "window", "dialog"):
        window = accessible.name
    if box is not None and states.contains(pyatspi.STATE_SHOWING):
        found.append(
            {
                "name": accessible.name,
                "description": accessible.description,
                "role": role,
                "window": window,
                "x": box.x,
                "y": box.y,
                "width": box.width,
                "height": box.height,
                "enabled": states.contains(pyatspi.STATE_ENABLED),
                "focusable": states.contains(pyatspi.STATE_FOCUSABLE),
                "focused": states.contains(pyatspi.STATE_FOCUSED),
                "checked": states.contains(pyatspi.STATE_CHECKED),
                "text": text_of(accessible),
            }
        )
    for child in list(accessible):
        if child is not None:
            seen(child, window, found)


def text_of(accessible):
    """The text that can be read in it, if it has any."""
    try:
        text = accessible.queryText()
    except NotImplementedError:
        return ""
    return text.getText(0, min(text.characterCount, 5000))


for _ in sys.stdin:
    found = []
    for application in pyatspi.Registry.getDesktop(0):
        if application is not None:
            try:
                seen(application, "", found)
            except Exception as error:  # it changed while we looked: the next look will do
                print(f"{type(error).__name__}: {error}", file=sys.stderr)
    print(json.dumps(found), flush=True)
