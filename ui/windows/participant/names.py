"""The list of what a treasure may be."""

from PySide6.QtCore import QEvent, QModelIndex, QSize, Qt, Signal
from PySide6.QtGui import QFocusEvent, QKeyEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QFrame,
    QListWidget,
    QWidget,
)

from ui.model.keys import typed_name
from ui.windows.look import GAP
from ui.windows.participant import focus


class Names(QListWidget):
    """What it may be. Nothing is picked until somebody picks.

    Attributes:
        picked: a name, by the person.
    """

    picked = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setAccessibleName("What it may be")
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setUniformItemSizes(True)
        self.setProperty("roomy", True)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._names: tuple[str, ...] = ()
        self.itemClicked.connect(lambda item: self.picked.emit(item.text()))

    def show_names(self, names: tuple[str, ...], picked: str | None) -> None:
        """Show these, with this one picked."""
        if names != self._names:
            self._names = names
            self.clear()
            self.addItems(list(names))
            self.updateGeometry()
        row = names.index(picked) if picked in names else -1
        if row != self.currentRow() or (row < 0) == bool(self.selectedIndexes()):
            if row < 0:
                self.setCurrentIndex(QModelIndex())
                self.clearSelection()
            else:
                self.setCurrentRow(row)
        self.setAccessibleDescription(f"Picked: {picked}" if picked else "Nothing is picked")

    def sizeHint(self) -> QSize:
        """All names, up to eight."""
        row = max(self.sizeHintForRow(0), 24)
        return QSize(220, row * min(max(len(self._names), 3), 8) + 2 * GAP)

    def minimumSizeHint(self) -> QSize:
        """Two names."""
        return QSize(150, max(self.sizeHintForRow(0), 24) * 2 + 2 * GAP)

    def event(self, event: QEvent) -> bool:
        """Keep the keys that pick a name, which the window's shortcuts would take."""
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent) and self._wanted(event):
            event.accept()
            return True
        return super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Arrows go up and down the list and leave it sideways, letters go to the next name that begins so."""
        name = self._wanted(event)
        if name is not None:
            self.picked.emit(name)
        elif event.key() in focus.ARROWS:
            focus.move(self, event.key())
        else:
            event.ignore()

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Having the focus picks nothing, which Qt's own lists do."""
        current = self.currentIndex()
        super().focusInEvent(event)
        if not current.isValid():
            self.setCurrentIndex(QModelIndex())
        self.viewport().update()

    def _wanted(self, event: QKeyEvent) -> str | None:
        """The name that a key picks."""
        if not self._names or event.modifiers() not in (
            Qt.KeyboardModifier.NoModifier,
            Qt.KeyboardModifier.ShiftModifier,
        ):
            return None
        row = self.currentRow()
        last = len(self._names) - 1
        rows: dict[int, int] = {
            Qt.Key.Key_Up: max(row - 1, 0) if row >= 0 else last,
            Qt.Key.Key_Down: min(row + 1, last),
            Qt.Key.Key_Home: 0,
            Qt.Key.Key_End: last,
        }
        if event.key() in rows:
            return self._names[rows[event.key()]]
        letter = event.text().strip()
        if not letter.isalpha():
            return None
        return typed_name(letter, self._names, self._names[row] if row >= 0 else None)
