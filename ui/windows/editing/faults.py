"""List of an edited file's faults, and of notices about entries that have no effect."""

from collections.abc import Callable, Sequence

from PySide6.QtCore import Signal, Slot
from PySide6.QtWidgets import QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from thbridge.files.errors import BadFile
from ui.windows.look import GAP, follow_text, label, px, spaced

_TALLEST = 104


class FaultList(QWidget):
    """Line with the number of faults, and a list of all faults and notices below this line.

    Args:
        fine: sentence that is shown if there are no faults.
        shortened: function that removes from a sentence what the window shows elsewhere, such as the file's name.

    Attributes:
        chosen: signal: a person wants to see the fault with this index.
    """

    chosen = Signal(int)

    def __init__(self, fine: str, shortened: Callable[[str], str]) -> None:
        super().__init__()
        self._fine, self._shortened = fine, shortened
        self.list = QListWidget()
        self.list.setAccessibleName("Faults and notices")
        follow_text(self.list, _fit)
        self.list.itemClicked.connect(self._choose)
        self.list.itemActivated.connect(self._choose)
        self._verdict = label("", "small")
        self._count = 0
        column = spaced(QVBoxLayout(self), GAP // 2, 0)
        column.addWidget(self._verdict)
        column.addWidget(self.list)

    def show_faults(self, faults: Sequence[BadFile], notices: Sequence[str] = ()) -> None:
        """Show faults and notices."""
        self._count = len(faults)
        lines = [f"⚠ {self._shortened(str(fault))}" for fault in faults]
        lines += [f"ℹ {self._shortened(notice)}" for notice in notices]
        if lines != [self.list.item(row).text() for row in range(self.list.count())]:
            self.list.clear()
            for line in lines:
                self.list.addItem(QListWidgetItem(line))
        self.list.setVisible(bool(lines))
        _fit(self.list)
        words = f"{self._count} fault{'s' if self._count > 1 else ''}"
        self._verdict.setText(f"⚠ {words}. Press F8 to go to the next fault." if self._count else f"✓ {self._fine}")
        self._verdict.setProperty("bad", bool(self._count))
        self._verdict.style().unpolish(self._verdict)
        self._verdict.style().polish(self._verdict)

    @Slot()
    def choose_next(self) -> None:
        """Go to the next fault."""
        if self._count:
            row = (self.list.currentRow() + 1) % self._count
            self.list.setCurrentRow(row)
            self.chosen.emit(row)

    def _choose(self, item: QListWidgetItem) -> None:
        if self.list.row(item) < self._count:
            self.chosen.emit(self.list.row(item))


def _fit(shown: QListWidget) -> None:
    """Give the list the height of its rows and of its scroll bar, up to a maximum."""
    height = sum(shown.sizeHintForRow(row) for row in range(shown.count())) + 2 * GAP
    height += shown.horizontalScrollBar().sizeHint().height()
    shown.setFixedHeight(min(px(_TALLEST), height))
