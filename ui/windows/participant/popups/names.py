"""List of possible names of a treasure."""

from PySide6.QtCore import QModelIndex, QSize, Qt, Signal
from PySide6.QtGui import QFocusEvent, QHideEvent, QKeyEvent, QMouseEvent, QShowEvent
from PySide6.QtWidgets import (
    QAbstractItemView,
    QFrame,
    QListWidget,
    QWidget,
)

from thbridge.dialogue.wording.texts import Texts
from ui.windows.look import GAP, px
from ui.windows.participant.widgets import focus


class NameList(QListWidget):
    """List of possible names of a treasure. At first, no name is picked.

    Attributes:
        picked: signal with the name that the person picked.
    """

    picked = Signal(str)

    def __init__(self, texts: Texts, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._texts = texts
        self.setAccessibleName(texts.text("window.possible_names"))
        self.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setUniformItemSizes(True)
        # There is no horizontal scroll bar, because it would cover one of only two visible names. Names that are cut
        # off have a tool tip instead.
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setProperty("roomy", True)
        self.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._names: tuple[str, ...] = ()
        self._called: tuple[str, ...] = ()
        self._worth: tuple[int | None, ...] = ()
        self._picked: str | None = None
        self._high = 24
        self.itemClicked.connect(lambda item: self.picked.emit(self._names[self.row(item)]))

    def show_names(
        self,
        names: tuple[str, ...],
        picked: str | None,
        worth: tuple[int | None, ...] = (),
        called: tuple[str, ...] = (),
    ) -> None:
        """Show names.

        Args:
            names: the names.
            picked: the picked name. If None, no name is picked.
            worth: points that each name is worth, if known.
            called: words to show for each name. If empty, the names themselves are shown.
        """
        self._picked, called = picked, called or names
        if (names, called, worth) != (self._names, self._called, self._worth) or self.count() == 0:
            self._names, self._called, self._worth = names, called, worth
            self._fill()
            self.updateGeometry()
        self._pick()
        texts = self._texts
        none = texts.text("window.nothing_picked")
        words = dict(zip(names, called, strict=True)).get(picked or "", picked)
        said = texts.text("window.picked", name=words) if words else none
        self.setAccessibleDescription(said)

    def sizeHint(self) -> QSize:
        """Return a size for all names, but at least for three names and at most for eight names."""
        return QSize(px(220), self._high * min(max(len(self._names), 3), 8) + 2 * GAP)

    def widest(self) -> int:
        """Return the width at which the longest name is fully visible."""
        words = self._rows()
        bar = self.verticalScrollBar().sizeHint().width()
        wide = max((self.fontMetrics().horizontalAdvance(each) for each in words), default=0)
        return wide + bar + 4 * GAP - 4

    def minimumSizeHint(self) -> QSize:
        """Return a size for two names."""
        return QSize(px(110), self._high * 2 + 2 * GAP)

    def showEvent(self, event: QShowEvent) -> None:
        """Fill the list when it becomes visible."""
        if self.count() == 0:
            self._fill()
            self._pick()
        super().showEvent(event)

    def hideEvent(self, event: QHideEvent) -> None:
        """Empty the list, because assistive technology would find the names even in a hidden list."""
        super().hideEvent(event)
        self.clear()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move the focus out of the list with the arrow keys; the window's shortcuts pick the names."""
        if event.key() in focus.ARROWS:
            focus.move_focus(self, event.key())
        else:
            event.ignore()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        """Do nothing, because only a click picks a name, and not a drag over the list."""
        event.accept()

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Handle the end of a click. If the click picked no name, the picked name stays marked."""
        super().mouseReleaseEvent(event)
        self._pick()

    def focusInEvent(self, event: QFocusEvent) -> None:
        """Accept the focus without picking a name; Qt's own lists would select their first entry."""
        current = self.currentIndex()
        super().focusInEvent(event)
        if not current.isValid():
            self.setCurrentIndex(QModelIndex())
        self.viewport().update()

    def _fill(self) -> None:
        self.clear()
        self.addItems(self._rows())
        for row in range(self.count()):
            self.item(row).setToolTip(self.item(row).text())  # a narrow list cuts off the name
        self._high = max(self.sizeHintForRow(0), self._high)

    def _pick(self) -> None:
        row = self._names.index(self._picked) if self._picked in self._names else -1
        if row == self.currentRow() and (row < 0) != bool(self.selectedIndexes()):
            return
        if row < 0:
            self.setCurrentIndex(QModelIndex())
            self.clearSelection()
        else:
            self.setCurrentRow(row)

    def _rows(self) -> list[str]:
        """Return the lines of the list: the words for each name, with the points if known."""
        texts, worth = self._texts, self._worth or (None,) * len(self._called)
        return [
            words
            if points is None
            else texts.text("window.name_points", name=words, points=texts.text("words.points", count=points))
            for words, points in zip(self._called, worth, strict=True)
        ]
