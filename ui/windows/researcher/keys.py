"""Keys of the researcher's window, and the sheet that lists them."""

from PySide6.QtCore import QSize, Qt
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from ui.windows.look import FRAME, follow_text, font, spaced
from ui.windows.researcher.docks.displays import SWITCHES
from ui.windows.researcher.map.tools import TOOLS

KeyLines = tuple[tuple[str, str], ...]

GROUPS: tuple[tuple[str, KeyLines], ...] = (
    (
        "Time",
        (
            ("Space", "play or pause, wherever the focus is but in a field of text"),
            (". and ,", "one step forward, one step back"),
            ("] and [", "faster, slower"),
            ("Home, End", "to the beginning, to the end (recordings)"),
            ("PgUp, PgDown", "to the mark before, to the next mark (recordings)"),
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
            ("F6", "to the next part of the window; with Shift the one before"),
            ("Enter", "press the button with the focus, tick the box, open the list of choices"),
            ("Ctrl+F", "filter the list on view"),
            ("Ctrl+C", "copy the rows selected"),
            ("Ctrl +, Ctrl -", "larger text, smaller text; Ctrl 0: the usual size"),
            ("F1", "this sheet"),
        ),
    ),
)


class KeySheet(QDialog):
    """All keys on one sheet."""

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle("Keys")
        columns = spaced(QHBoxLayout(), 40)
        for groups in (GROUPS[::2], GROUPS[1::2]):
            column = spaced(QVBoxLayout(), 20)
            for title, keys in groups:
                column.addLayout(_group(title, keys))
            column.addStretch(1)
            columns.addLayout(column)
        close = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        close.rejected.connect(self.reject)
        inside, area = QWidget(), QScrollArea(widgetResizable=True)
        inside.setLayout(columns)
        area.setWidget(inside)
        area.setAccessibleName("Keys and what they do")
        layout = QVBoxLayout(self)
        layout.setContentsMargins(24, 24, 24, 24)
        layout.addWidget(area)
        layout.addWidget(close)
        bar = area.verticalScrollBar().sizeHint().width()
        wanted = inside.sizeHint() + QSize(48 + bar, 64 + bar + close.sizeHint().height())
        self.resize(wanted.boundedTo(parent.screen().availableSize() - FRAME))


def _group(title: str, keys: KeyLines) -> QGridLayout:
    grid = QGridLayout()
    grid.setHorizontalSpacing(16)
    grid.setVerticalSpacing(4)
    grid.addWidget(_bold(title), 0, 0, 1, 2)
    for row, (key, what) in enumerate(keys, start=1):
        grid.addWidget(_bold(key), row, 0)
        grid.addWidget(QLabel(what), row, 1)
    grid.setColumnStretch(1, 1)
    return grid


def _bold(words: str) -> QLabel:
    return follow_text(QLabel(words), lambda it: it.setFont(font(bold=True)))
