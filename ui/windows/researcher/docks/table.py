"""Tables of the docks: the base of their models, and their views."""

from collections.abc import Sequence

from PySide6.QtCore import QAbstractTableModel, QModelIndex, QObject, QPersistentModelIndex, Qt
from PySide6.QtGui import QFontMetrics
from PySide6.QtWidgets import QHeaderView, QTableView

from ui.windows.look import follow_text, font

ModelIndex = QModelIndex | QPersistentModelIndex
NO_PARENT = QModelIndex()
LEFT = Qt.AlignmentFlag.AlignLeft | Qt.AlignmentFlag.AlignVCenter
RIGHT = int(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)


class TableModel(QAbstractTableModel):
    """Rows under titles; a subclass keeps the rows in `_shown`, and tells of their cells.

    Args:
        titles: of the columns.
        hints: tool tips of the titles; none for none.
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
        """Have all cells of these rows drawn anew."""
        self.dataChanged.emit(self.index(first, 0), self.index(last, self._columns - 1))


def row_table(
    name: str, model: TableModel, mode: QTableView.SelectionMode, lines: int, characters: Sequence[int]
) -> QTableView:
    """A table of which whole rows are selected.

    Args:
        name: for people.
        model: its rows.
        mode: how many rows may be selected.
        lines: of words in a row.
        characters: width of each column; 0 for one that is set elsewhere.
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
