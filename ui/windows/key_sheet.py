"""Sheet with the keyboard shortcuts of a window."""

from collections.abc import Sequence

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
from ui.windows.untrusted_text import PlainLabel

KeyLines = tuple[tuple[str, str], ...]
"""Keys and their actions."""


class KeySheet(QDialog):
    """Sheet with all keyboard shortcuts.

    Args:
        parent: the window.
        keys: groups of shortcuts, each with its title.
    """

    def __init__(self, parent: QWidget, keys: Sequence[tuple[str, KeyLines]]) -> None:
        super().__init__(parent)
        self.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.setWindowTitle("Keyboard shortcuts")
        columns = spaced(QHBoxLayout(), 40)
        for groups in (keys[::2], keys[1::2]):
            column = spaced(QVBoxLayout(), 20)
            for title, lines in groups:
                column.addLayout(_group(title, lines))
            column.addStretch(1)
            columns.addLayout(column)
        close = QDialogButtonBox(QDialogButtonBox.StandardButton.Close)
        close.rejected.connect(self.reject)
        inside, area = QWidget(), QScrollArea(widgetResizable=True)
        inside.setLayout(columns)
        area.setWidget(inside)
        area.setAccessibleName("Keyboard shortcuts")
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
        grid.addWidget(PlainLabel(what), row, 1)
    grid.setColumnStretch(1, 1)
    return grid


def _bold(words: str) -> QLabel:
    return follow_text(PlainLabel(words), lambda it: it.setFont(font(bold=True)))
