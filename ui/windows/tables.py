"""Tables of windows: base classes of their models, and a function that creates their views."""

from collections.abc import Sequence

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QPersistentModelIndex, Qt
from PySide6.QtGui import QColor, QFontMetrics
from PySide6.QtWidgets import QHeaderView, QTableView

from ui.windows.look import colours, follow_text, font
from ui.windows.untrusted_text import shown

ModelIndex = QModelIndex | QPersistentModelIndex
NO_PARENT = QModelIndex()
LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
RIGHT = int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)


class TableModel(QAbstractTableModel):
    """Base class of models with rows below titles. A subclass stores the rows in `_shown`, and returns cell data.

    Args:
        titles: titles of the columns.
        hints: tool tips of the titles. If empty, there are no tool tips.
    """

    _shown: Sequence[object] = ()

    def __init__(self, titles: Sequence[str], hints: Sequence[str], parent: QObject | None) -> None:
        super().__init__(parent)
        self._headers: dict[int, Sequence[str]] = {
            Qt.ItemDataRole.DisplayRole: titles,
            Qt.ItemDataRole.ToolTipRole: hints,
        }
        self._columns = len(titles)

    def rowCount(self, parent: ModelIndex = NO_PARENT) -> int:
        """Return the number of rows shown."""
        return 0 if parent.isValid() else len(self._shown)

    def columnCount(self, parent: ModelIndex = NO_PARENT) -> int:
        """Return the number of columns."""
        return 0 if parent.isValid() else self._columns

    def headerData(self, section: int, orientation: Qt.Orientation, role: int = 0) -> object:
        """Return the title of a column, or its tool tip."""
        headers = self._headers.get(role, ())
        return headers[section] if orientation == Qt.Orientation.Horizontal and headers else None

    def _changed(self, first: int, last: int) -> None:
        """Request a repaint of all cells in these rows."""
        self.dataChanged.emit(self.index(first, 0), self.index(last, self._columns - 1))


class TextModel(TableModel):
    """Model with rows of texts, which may all change at once."""

    _shown: Sequence[tuple[str, ...]] = ()

    def __init__(self, titles: Sequence[str], parent: QObject, *, has_time: bool = False) -> None:
        super().__init__(titles, (), parent)
        self._has_time = has_time

    def show_rows(self, texts: Sequence[tuple[str, ...]]) -> bool:
        """Show these rows. Return False if they are already shown."""
        if tuple(texts) == self._shown:
            return False
        self.beginResetModel()
        self._shown = tuple(texts)
        self.endResetModel()
        return True

    def data(self, index: ModelIndex, role: int = 0) -> object:
        """Return a cell's text, alignment, color or tool tip."""
        is_time = self._has_time and index.column() == 0
        if role in (Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole):
            return shown(self._shown[index.row()][index.column()])
        if role == Qt.ItemDataRole.TextAlignmentRole and is_time:
            return RIGHT
        if role == Qt.ItemDataRole.ForegroundRole and is_time:
            return QColor(colours().muted)
        return None


class GrowingModel(TextModel):
    """Model with a growing list of rows of texts. Some rows may also change. The selected rows stay selected."""

    def show_rows(self, texts: Sequence[tuple[str, ...]]) -> bool:
        """Show these rows; return False if they are already shown."""
        before, now = self._shown, tuple(texts)
        if len(now) < len(before):
            return super().show_rows(now)
        self._shown = now[: len(before)]
        for number, (was, row) in enumerate(zip(before, now, strict=False)):
            if was != row:
                self._changed(number, number)
        if len(now) > len(before):
            self.beginInsertRows(NO_PARENT, len(before), len(now) - 1)
            self._shown = now
            self.endInsertRows()
        return now != tuple(before)


def row_table(
    name: str, model: TableModel, mode: QTableView.SelectionMode, lines: int, characters: Sequence[int]
) -> QTableView:
    """Return a table that selects whole rows.

    Args:
        name: name for people.
        model: model of the rows.
        mode: number of rows that can be selected.
        lines: lines of text in a row.
        characters: width of each column, characters; 0 if the caller sets the width.
    """
    table = QTableView(showGrid=False, wordWrap=False)
    table.setAccessibleName(name)
    table.setModel(model)
    table.setSelectionBehavior(QTableView.SelectionBehavior.SelectRows)
    table.setSelectionMode(mode)
    table.setTabKeyNavigation(False)
    table.verticalHeader().hide()
    table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeMode.Fixed)
    table.horizontalHeader().setDefaultAlignment(LEFT)

    def fit(table: QTableView) -> None:
        metrics = QFontMetrics(font())
        table.verticalHeader().setDefaultSectionSize(lines * metrics.height() + 4 + 4 * lines)
        for column, wide in enumerate(characters):
            if wide:
                table.setColumnWidth(column, wide * metrics.averageCharWidth())

    follow_text(table, fit)
    return table
