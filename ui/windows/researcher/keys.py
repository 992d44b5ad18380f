"""Keyboard shortcuts of the researcher's window."""

from ui.windows.key_sheet import KeyLines
from ui.windows.researcher.docks.displays import SWITCHES
from ui.windows.researcher.map.tools import TOOLS

GROUPS: tuple[tuple[str, KeyLines], ...] = (
    (
        "Time",
        (
            ("Space", "play or pause, unless a text field has the focus"),
            (". and ,", "go one step forward, go one step back"),
            ("] and [", "play faster, play slower"),
            ("Home, End", "go to the beginning, go to the end (recordings)"),
            ("PgUp, PgDown", "go to the previous, to the next mark or bookmark (recordings)"),
            ("Ctrl+T", "go to a time that you type (recordings)"),
            ("B", "set a bookmark, or remove it (recordings)"),
            ("L", "play repeatedly between two bookmarks (recordings)"),
        ),
    ),
    (
        "Robots",
        (
            ("Tab", "on the map: select the next robot; with Shift, the previous robot"),
            ("F", "follow the selected robot, or stop following it"),
            ("Delete", "kill the selected robot, after confirmation"),
            ("R", "revive the selected robot"),
            ("C", "clear the costmaps of the selected robot"),
        ),
    ),
    (
        "Tools on the map",
        (
            *((tool.key, tool.label.lower()) for tool in TOOLS.values()),
            ("Esc", "stop using the tool"),
            ("A", "show the whole map"),
        ),
    ),
    ("Displays", tuple((switch.key, switch.label.lower()) for switch in SWITCHES.values() if switch.key)),
    (
        "Window",
        (
            ("Ctrl+O", "open a recording or a session"),
            ("F6", "go to the next part of the window; with Shift, to the previous part"),
            ("Enter", "press the focused button, tick the focused box, open the focused list"),
            ("Ctrl+F", "type a filter for the visible list"),
            ("Ctrl+C", "copy the selected rows of a list"),
            ("Ctrl +, Ctrl -", "enlarge text, shrink text; Ctrl 0 restores the usual size"),
            ("Ctrl+,", "open the settings: colors, text size"),
            ("F1", "open this sheet"),
        ),
    ),
)
