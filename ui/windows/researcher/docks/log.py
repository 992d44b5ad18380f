"""Lists of protocol lines, dialogue, events and inputs, in chronological order."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QSignalBlocker, Qt, Signal
from PySide6.QtGui import QColor, QGuiApplication, QKeySequence, QShortcut
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QLineEdit, QTableView, QVBoxLayout, QWidget

from ui.windows.look import colours
from ui.windows.tables import NO_PARENT, RIGHT, ModelIndex, TableModel, row_table
from ui.windows.untrusted_text import PlainLabel, shown

MAX_ROWS = 20_000
"""Maximum number of rows in a list. The oldest rows are dropped first."""
DROPPED_AT_ONCE = MAX_ROWS // 10
"""Number of rows dropped at once, so that a full list does not drop a row for each added row."""


@dataclass(frozen=True, slots=True)
class LogRow:
    """Row with one sentence, event, line or input.

    Attributes:
        time: seconds since the beginning.
        cells: texts of the columns after the time.
        robot: index of the robot whose color the row has. If None, the row has no color.
    """

    time: float
    cells: tuple[str, ...]
    robot: int | None = None


class LogModel(TableModel):
    """Model of the rows that match the filter, in chronological order.

    Rows later than the time shown are dimmed; a recording contains these rows as well.

    Args:
        columns: titles of the columns after the time.
    """

    _shown: list[LogRow]

    def __init__(self, columns: Sequence[str], parent: QWidget | None = None) -> None:
        super().__init__(("Time", *columns), (), parent)
        self._rows: list[LogRow] = []
        self._texts: list[str] = []
        self._words: tuple[str, ...] = ()
        self._shown = []
        self._now = float("inf")
        self._past = 0

    # Contents

    @property
    def size(self) -> int:
        """Number of all rows, including rows that the filter hides."""
        return len(self._rows)

    @property
    def last_past(self) -> int:
        """Index of the last row up to the time shown; -1 before the first row."""
        return self._past - 1

    def row(self, number: int) -> LogRow:
        """Return a visible row, given its index."""
        return self._shown[number]

    def extend(self, rows: Sequence[LogRow]) -> None:
        """Append rows, in chronological order, after the rows of the list."""
        if not rows:
            return
        rows = rows[-MAX_ROWS:]
        texts = [" ".join(row.cells).lower() for row in rows]
        if len(self._rows) + len(rows) > MAX_ROWS:
            self._rows = self._rows[max(0, len(self._rows) + len(rows) - MAX_ROWS) + DROPPED_AT_ONCE :] + list(rows)
            self._texts = self._texts[len(self._texts) - (len(self._rows) - len(rows)) :] + texts
            self._choose()
            return
        self._rows += rows
        self._texts += texts
        fit = [row for row, text in zip(rows, texts, strict=True) if self._fits(text)]
        if fit:
            self.beginInsertRows(NO_PARENT, len(self._shown), len(self._shown) + len(fit) - 1)
            self._shown += fit
            self._past = bisect_right(self._shown, self._now, key=lambda row: row.time)
            self.endInsertRows()

    def clear(self) -> None:
        """Remove all rows."""
        self.beginResetModel()
        self._rows, self._texts, self._shown, self._past = [], [], [], 0
        self.endResetModel()

    def set_filter(self, text: str) -> None:
        """Show only rows that contain all these words, without regard to case."""
        self._words = tuple(text.lower().split())
        self._choose()

    def show_time(self, now: float) -> None:
        """Dim the rows after this time."""
        self._now = now
        past = bisect_right(self._shown, now, key=lambda row: row.time)
        if past != self._past:
            low, high = sorted((past, self._past))
            self._past = past
            self._changed(low, high - 1)

    def _choose(self) -> None:
        self.beginResetModel()
        self._shown = [row for row, text in zip(self._rows, self._texts, strict=True) if self._fits(text)]
        self._past = bisect_right(self._shown, self._now, key=lambda row: row.time)
        self.endResetModel()

    def _fits(self, text: str) -> bool:
        return all(word in text for word in self._words)

    def data(self, index: ModelIndex, role: int = 0) -> object:
        """Return a cell's text, its color, or its tool tip."""
        row = self._shown[index.row()]
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
            return f"{row.time:.2f}" if index.column() == 0 else shown(row.cells[index.column() - 1])
        if role == Qt.ItemDataRole.TextAlignmentRole and index.column() == 0:
            return RIGHT
        if role == Qt.ItemDataRole.ForegroundRole:
            if index.row() >= self._past or index.column() == 0:
                return QColor(colours().muted)
            if row.robot is not None and index.column() == 1:
                return QColor(colours().robot(row.robot))
        return None


class LogView(QWidget):
    """List with a filter. It scrolls to the displayed time by itself until a person scrolls it.

    Args:
        name: name of the list for screen readers.
        columns: titles of the columns after the time.

    Signals:
        chosen: a person wants to go to the time of a row; seconds since the beginning.
    """

    chosen = Signal(float)

    def __init__(self, name: str, columns: Sequence[str]) -> None:
        super().__init__()
        self.model = LogModel(columns, self)
        self._scrolls = False
        self._filter = QLineEdit(placeholderText="Filter: words that a row must contain", clearButtonEnabled=True)
        self._filter.setAccessibleName(f"Filter of {name}")
        self._filter.textChanged.connect(self._filtered)
        self._follows = QCheckBox("Follow the time")
        self._follows.setAccessibleDescription("Scroll with the time shown, until you scroll the list yourself")
        self._follows.setChecked(True)
        self._follows.toggled.connect(self._keep_up)
        self._count = PlainLabel()
        extended = QTableView.SelectionMode.ExtendedSelection
        self.table = row_table(name, self.model, extended, 1, (9, *(12 for _ in columns)))
        self.table.horizontalHeader().setStretchLastSection(True)
        self.table.activated.connect(lambda index: self.chosen.emit(self.model.row(index.row()).time))
        self.table.verticalScrollBar().valueChanged.connect(self._scrolled)
        copy = QShortcut(QKeySequence(QKeySequence.StandardKey.Copy), self.table)
        copy.setContext(Qt.ShortcutContext.WidgetShortcut)
        copy.activated.connect(self.copy)
        top = QHBoxLayout()
        top.addWidget(self._filter, 1)
        top.addWidget(self._count)
        top.addWidget(self._follows)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 8)
        layout.addLayout(top)
        layout.addWidget(self.table, 1)
        self._show_size()

    def extend(self, rows: Sequence[LogRow]) -> None:
        """Append rows, in chronological order, after the rows of the list."""
        if rows:
            self.model.extend(rows)
            self._show_size()
            self._keep_up()

    def clear(self) -> None:
        """Remove all rows."""
        self.model.clear()
        self._show_size()

    def show_time(self, now: float) -> None:
        """Scroll to this time, unless a person has scrolled to other rows."""
        before = self.model.last_past
        self.model.show_time(now)
        if self.model.last_past != before:
            self._keep_up()

    def focus_filter(self) -> None:
        """Give the filter the focus."""
        self._filter.setFocus(Qt.FocusReason.ShortcutFocusReason)

    def copy(self) -> None:
        """Copy the selected rows to the clipboard, with tab characters between cells."""
        numbers = sorted(index.row() for index in self.table.selectionModel().selectedRows())
        rows = (self.model.row(number) for number in numbers)
        QGuiApplication.clipboard().setText("\n".join("\t".join((f"{row.time:.3f}", *row.cells)) for row in rows))

    def _filtered(self, text: str) -> None:
        self.model.set_filter(text)
        self._show_size()
        self._keep_up()

    def _show_size(self) -> None:
        shown, size = self.model.rowCount(), self.model.size
        self._count.setText(f"{size:,} rows" if shown == size else f"{shown:,} of {size:,} rows")

    def _keep_up(self) -> None:
        if self._follows.isChecked() and self.model.last_past >= 0:
            self._scrolls = True
            self.table.doItemsLayout()  # Without this, the scroll bar would ignore the newest rows.
            self.table.scrollTo(self.model.index(self.model.last_past, 0), QTableView.ScrollHint.EnsureVisible)
            self._scrolls = False

    def _scrolled(self) -> None:
        """Follow the time after a person has scrolled, but only if the row at the time shown is visible."""
        if self._scrolls or self.model.last_past < 0:
            return
        place = self.table.visualRect(self.model.index(self.model.last_past, 0))
        with QSignalBlocker(self._follows):
            self._follows.setChecked(self.table.viewport().rect().intersects(place))
