"""Page with a sheet of a template set. Each treasure or property has a row; some cells offer a list of choices."""

from collections.abc import Callable, Collection, Mapping
from functools import partial

from PySide6.QtCore import (
    QAbstractItemModel,
    QModelIndex,
    QPersistentModelIndex,
    QSignalBlocker,
    QSize,
    Qt,
    Signal,
    Slot,
)
from PySide6.QtGui import QIcon, QPixmap
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QHeaderView,
    QPushButton,
    QStyle,
    QStyledItemDelegate,
    QStyleOptionViewItem,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from thbridge.files.errors import BadFile
from thbridge.hunt.refusals import RequestRefused
from ui.model.template_set.sheet import Changed, Sheet
from ui.windows.controls import ChoiceBox
from ui.windows.look import GAP, follow_text, label, px, spaced

_LOOK = QSize(48, 36)
"""Size of a picture in a cell, `px`."""
_WIDEST = 260
"""Maximum automatic width of a column, `px`."""

_Index = QModelIndex | QPersistentModelIndex


class SheetPage(QWidget):
    """Page with a table in which people type or choose values, and buttons that add and remove rows.

    Signals:
        changed: a person changed the sheet; with the new texts of the changed files.

    Args:
        name: name of the kind of rows, such as `treasure`.
        sheet: function that returns the sheet for the current texts; None if the texts cannot be read as a sheet.

    Attributes:
        table: table with the cells.
    """

    changed = Signal(object)

    def __init__(self, name: str, sheet: Callable[[], Sheet | None]) -> None:
        super().__init__()
        self._sheet = sheet
        self._shown: Sheet | None = None
        self.table = QTableWidget()
        self.table.setAccessibleName(f"Table of {name}s")
        self.table.setTabKeyNavigation(False)
        self.table.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self.table.setEditTriggers(
            QAbstractItemView.EditTrigger.DoubleClicked
            | QAbstractItemView.EditTrigger.EditKeyPressed
            | QAbstractItemView.EditTrigger.AnyKeyPressed
            | QAbstractItemView.EditTrigger.SelectedClicked
        )
        self._choices = _Choices(self.table, self._choices_of)
        self.table.setItemDelegate(self._choices)
        self.table.verticalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        follow_text(self.table, _fit)
        self.table.itemChanged.connect(self._typed)
        self.table.currentCellChanged.connect(self._show_meaning)
        self._meaning = label("", "small", muted=True)
        self._meaning.setWordWrap(True)
        self.add = QPushButton(f"Add a {name}")
        self.copy = QPushButton("Copy")
        self.copy.setAccessibleName(f"Copy the selected {name}")
        self.remove = QPushButton("Remove")
        self.remove.setAccessibleName(f"Remove the selected {name}")
        self.add.clicked.connect(self._add)
        self.copy.clicked.connect(self._copy)
        self.remove.clicked.connect(self._remove)
        buttons = spaced(QHBoxLayout(), GAP)
        for button in (self.add, self.copy, self.remove):
            buttons.addWidget(button)
        buttons.addStretch(1)
        column = spaced(QVBoxLayout(self), GAP, GAP)
        column.addWidget(self.table, 1)
        column.addWidget(self._meaning)
        column.addLayout(buttons)

    def refresh(self, pictures: Mapping[str, bytes], faults: Collection[BadFile]) -> None:
        """Show the sheet for the current texts.

        Args:
            pictures: pictures of the set, by name.
            faults: faults of the set; the table marks the faults that concern a cell.
        """
        sheet = self._shown = self._sheet()
        self.setEnabled(sheet is not None)
        if sheet is None:
            self._meaning.setText("⚠ The file cannot be read as a table. See the faults below.")
            return
        rows, wrong = sheet.rows, dict[tuple[int, int], str]()
        for fault in faults:
            if (cell := sheet.cell_of(fault)) is not None:
                wrong.setdefault(cell, f"{fault.problem}. {fault.remedy[:1].upper()}{fault.remedy[1:]}.")
        with QSignalBlocker(self.table):
            self.table.setRowCount(len(rows))
            self.table.setColumnCount(len(sheet.columns))
            self.table.setHorizontalHeaderLabels([column.title for column in sheet.columns])
            for row, cells in enumerate(rows):
                for number, text in enumerate(cells):
                    self._show_cell(row, number, text, wrong.get((row, number), ""))
                    item = self.table.item(row, number)
                    if sheet.columns[number].is_picture and item is not None and text in pictures:
                        item.setIcon(_icon(pictures[text]))
        _fit(self.table)
        self._show_meaning()

    def go_to(self, fault: BadFile) -> bool:
        """Select the cell that a fault concerns. Return False if the fault concerns no cell."""
        cell = None if self._shown is None else self._shown.cell_of(fault)
        if cell is None:
            return False
        self.table.setCurrentCell(*cell)
        self.table.setFocus()
        return True

    def _show_cell(self, row: int, column: int, text: str, wrong: str) -> None:
        item = self.table.item(row, column)
        if item is None:
            item = QTableWidgetItem()
            self.table.setItem(row, column, item)
        item.setText(text)
        item.setIcon(self.style().standardIcon(QStyle.StandardPixmap.SP_MessageBoxWarning) if wrong else QIcon())
        item.setToolTip(wrong)
        item.setData(Qt.ItemDataRole.AccessibleDescriptionRole, wrong)

    def _choices_of(self, column: int) -> tuple[str, ...]:
        return () if self._shown is None else self._shown.columns[column].choices

    @Slot()
    def _show_meaning(self) -> None:
        sheet, item = self._shown, self.table.currentItem()
        for button in (self.copy, self.remove):
            button.setEnabled(self.table.currentRow() >= 0)
        if sheet is None:
            return
        if self.table.currentRow() < 0:
            self._meaning.setText("Select a cell and type a new value, or press F2 to edit the value.")
            return
        column = sheet.columns[item.column()]
        wrong = f"⚠ {item.toolTip()} " if item.toolTip() else ""
        self._meaning.setText(f"{wrong}{column.title}: {column.meaning}.")

    @Slot(QTableWidgetItem)
    def _typed(self, item: QTableWidgetItem) -> None:
        row, column, text = item.row(), item.column(), item.text()
        self._change(lambda sheet: sheet.put(row, column, text))

    @Slot()
    def _add(self) -> None:
        self._change(lambda sheet: sheet.add(), last=True)

    @Slot()
    def _copy(self) -> None:
        row = self.table.currentRow()
        self._change(lambda sheet: sheet.add(row), last=True)

    @Slot()
    def _remove(self) -> None:
        row = self.table.currentRow()
        self._change(lambda sheet: sheet.remove(row))

    def _change(self, made: Callable[[Sheet], Changed], *, last: bool = False) -> None:
        sheet = self._sheet()
        if sheet is None:
            return
        done = made(sheet)
        if not isinstance(done, RequestRefused):
            self.changed.emit(done)
            if last:
                self.table.setCurrentCell(self.table.rowCount() - 1, 0)
                self.table.setFocus()
            return
        self.changed.emit({})
        self._meaning.setText(f"⚠ {done.sentence}")


class _Choices(QStyledItemDelegate):
    """Delegate that offers a list in cells with choices."""

    def __init__(self, table: QTableWidget, choices: Callable[[int], tuple[str, ...]]) -> None:
        super().__init__(table)
        self._choices = choices

    def createEditor(self, parent: QWidget, option: QStyleOptionViewItem, index: _Index) -> QWidget:
        """Return the editor of a cell."""
        choices = self._choices(index.column())
        if not choices:
            return super().createEditor(parent, option, index)
        box = ChoiceBox(parent)
        now = str(index.data() or "")
        box.addItems([*choices, *([] if now in choices else [now])])
        box.activated.connect(partial(self._choose, box))
        return box

    def _choose(self, box: ChoiceBox, _index: int) -> None:
        self.commitData.emit(box)
        self.closeEditor.emit(box)

    def setEditorData(self, editor: QWidget, index: _Index) -> None:
        """Show the value of the cell."""
        if isinstance(editor, ChoiceBox):
            editor.setCurrentText(str(index.data() or ""))
        else:
            super().setEditorData(editor, index)

    def setModelData(self, editor: QWidget, model: QAbstractItemModel, index: _Index) -> None:
        """Write the choice into the cell."""
        if isinstance(editor, ChoiceBox):
            model.setData(index, editor.currentText())
        else:
            super().setModelData(editor, model, index)


def _fit(table: QTableWidget) -> None:
    """Give each column the width of its contents."""
    table.setIconSize(QSize(px(_LOOK.width()), px(_LOOK.height())))
    table.resizeColumnsToContents()
    for number in range(table.columnCount()):
        table.setColumnWidth(number, min(px(_WIDEST), table.columnWidth(number) + GAP))


def _icon(data: bytes) -> QIcon:
    shown = QPixmap()
    shown.loadFromData(data)
    return QIcon(shown)
