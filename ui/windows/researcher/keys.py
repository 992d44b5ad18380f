"""Keyboard shortcuts of the researcher's window."""

from ui.windows.key_sheet import KeyLines
from ui.windows.researcher.docks.displays import SWITCHES
from ui.windows.researcher.map.tools import TOOLS

GROUPS: tuple[tuple[str, KeyLines], ...] = (
    (
        "Time",
        (
            ("Space", "play or pause, except in a text field"),
            (". and ,", "one step forward, one step back"),
            ("] and [", "faster, slower"),
            ("Home, End", "to the beginning, to the end (recordings)"),
            ("PgUp, PgDown", "to the previous mark or bookmark, to the next one (recordings)"),
            ("Ctrl+T", "type a time (recordings)"),
            ("B", "set a bookmark, or remove it (recordings)"),
            ("L", "loop between two bookmarks (recordings)"),
        ),
    ),
    (
        "Robots",
        (
            ("Tab", "on the map: the next robot; with Shift the previous one"),
            ("F", "follow the selected robot, or stop following it"),
            ("Delete", "kill the selected robot; asks first"),
            ("R", "revive it"),
            ("C", "clear its costmaps"),
        ),
    ),
    (
        "Tools on the map",
        (
            *((tool.key, tool.label.lower()) for tool in TOOLS.values()),
            ("Esc", "put the tool away"),
            ("A", "show the whole map"),
        ),
    ),
    ("Displays", tuple((switch.key, switch.label.lower()) for switch in SWITCHES.values() if switch.key)),
    (
        "Window",
        (
            ("Ctrl+O", "open a recording or a session"),
            ("F6", "to the next part of the window; with Shift the previous one"),
            ("Enter", "press the button with the focus, tick the box, open the list of choices"),
            ("Ctrl+F", "filter the visible list"),
            ("Ctrl+C", "copy the selected rows"),
            ("Ctrl +, Ctrl -", "larger text, smaller text; Ctrl 0: the usual size"),
            ("Ctrl+,", "settings: colors, text size"),
            ("F1", "this sheet"),
        ),
    ),
)
