"""Keys of the researcher's window."""

from ui.windows.key_sheet import KeyLines
from ui.windows.researcher.docks.displays import SWITCHES
from ui.windows.researcher.map.tools import TOOLS

GROUPS: tuple[tuple[str, KeyLines], ...] = (
    (
        "Time",
        (
            ("Space", "play or pause, wherever the focus is but in a field of text"),
            (". and ,", "one step forward, one step back"),
            ("] and [", "faster, slower"),
            ("Home, End", "to the beginning, to the end (recordings)"),
            ("PgUp, PgDown", "to the mark or bookmark before, to the next one (recordings)"),
            ("Ctrl+T", "type a time (recordings)"),
            ("B", "set a bookmark, or remove it (recordings)"),
            ("L", "play between two bookmarks again and again (recordings)"),
        ),
    ),
    (
        "Robots",
        (
            ("Tab", "on the map: the next robot; with Shift the one before"),
            ("F", "follow the robot selected, or stop that"),
            ("Delete", "kill the robot selected; asks first"),
            ("R", "revive it"),
            ("C", "clear its costmaps"),
        ),
    ),
    (
        "Tools on the map",
        (
            *((tool.key, tool.label.lower()) for tool in TOOLS.values()),
            ("Esc", "drop the tool"),
            ("A", "see all of the map"),
        ),
    ),
    ("Displays", tuple((switch.key, switch.label.lower()) for switch in SWITCHES.values() if switch.key)),
    (
        "Window",
        (
            ("Ctrl+O", "open a recording or a session"),
            ("F6", "to the next part of the window; with Shift the one before"),
            ("Enter", "press the button with the focus, tick the box, open the list of choices"),
            ("Ctrl+F", "filter the list on view"),
            ("Ctrl+C", "copy the rows selected"),
            ("Ctrl +, Ctrl -", "larger text, smaller text; Ctrl 0: the usual size"),
            ("Ctrl+,", "settings: colors, text size"),
            ("F1", "this sheet"),
        ),
    ),
)
