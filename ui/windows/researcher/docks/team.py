"""List of robots with error, standard deviation, energy, speed and state."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QModelIndex, Qt, Signal
from PySide6.QtGui import QColor, QFontMetrics, QIcon, QPainter, QPixmap, QResizeEvent
from PySide6.QtWidgets import QHeaderView, QTableView, QVBoxLayout, QWidget

from ui.windows.look import colours, follow_text, font, px
from ui.windows.tables import RIGHT, ModelIndex, TableModel, row_table


@dataclass(frozen=True, slots=True)
class RobotRow:
    """Values in a robot's row; unknown values are None.

    Attributes:
        name: name of the robot for people.
        state: activity of the robot in words.
        error: meters between true and estimated position.
        sigma: standard deviation of the estimated position, meters.
        energy: remaining energy.
        speed: speed, m/s.
        trouble: True if the state needs attention.
    """

    name: str
    state: str
    error: float | None
    sigma: float | None
    energy: float | None
    speed: float | None
    trouble: bool


TITLES = ("Robot", "Error, m", "σ, m", "Energy", "m/s")
HINTS = (
    "Name and activity of the robot",
    "Distance between true and believed position, meters",
    "Standard deviation of the position, as the robot reports it, meters",
    "Remaining energy",
    "Speed, meters per second",
)

CHARACTERS = (16, 8, 6, 7, 5)
"""Widths of the columns, characters; the first column also gets the remaining width."""

IMPORTANCE = (1, 3, 2, 4)
"""Columns with figures, the most important column first.

If names need the space, the last columns are hidden. The plots also show their values.
"""


class TeamModel(TableModel):
    """Model of the rows. Their number seldom changes, but their values change many times a second."""

    _shown: tuple[RobotRow, ...] = ()

    def show_rows(self, rows: Sequence[RobotRow]) -> None:
        """Show these rows, starting with robot 1."""
        rows = tuple(rows)
        if len(rows) != len(self._shown):
            self.beginResetModel()
            self._shown = rows
            self.endResetModel()
            return
        before, self._shown = self._shown, rows
        for number, (was, now) in enumerate(zip(before, rows, strict=True)):
            if was != now:
                self._changed(number, number)

    def data(self, index: ModelIndex, role: int = 0) -> object:
        """Return a cell's text, icon, color or tool tip."""
        row = self._shown[index.row()]
        if role == Qt.ItemDataRole.DisplayRole:
            return _cell(row, index.column())
        if role == Qt.ItemDataRole.DecorationRole and index.column() == 0:
            return self._chip(index.row())
        if role == Qt.ItemDataRole.ForegroundRole and index.column() == 0 and row.trouble:
            return QColor(colours().bad)
        if role == Qt.ItemDataRole.TextAlignmentRole and index.column() >= 1:
            return RIGHT
        if role == Qt.ItemDataRole.ToolTipRole and index.column() == 0:
            return row.state
        return None

    def _chip(self, robot: int) -> QIcon:
        """Return an icon in the robot's color.

        In a selected row, an edge separates the icon from the color of the selection.
        """
        chip = QPixmap(px(18), px(18))
        chip.fill(QColor(colours().panel))
        painter = QPainter(chip)
        painter.fillRect(chip.rect().adjusted(2, 2, -2, -2), QColor(colours().robot(robot)))
        painter.end()
        icon = QIcon(chip)
        icon.addPixmap(chip, QIcon.Mode.Selected)
        return icon


class TeamTable(QWidget):
    """List of robots. A click or the arrow keys select a robot.

    Signals:
        selected: a robot was selected; with its row.
    """

    selected = Signal(int)

    def __init__(self) -> None:
        super().__init__()
        self.model = TeamModel(TITLES, HINTS, self)
        single = QTableView.SelectionMode.SingleSelection
        self.table = row_table("Robots", self.model, single, 2, (0, *CHARACTERS[1:]))
        header = self.table.horizontalHeader()
        follow_text(header, lambda it: it.setMinimumSectionSize(px(34)))
        header.setSectionResizeMode(0, QHeaderView.ResizeMode.Stretch)
        self.table.selectionModel().currentRowChanged.connect(self._chosen)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.table)
        follow_text(self, lambda it: it._choose_columns())

    def show_rows(self, rows: Sequence[RobotRow], selected: int) -> None:
        """Show these rows, starting with robot 1, and select the row `selected`."""
        self.model.show_rows(rows)
        if 0 <= selected < len(rows) and self.table.currentIndex().row() != selected:
            self.table.selectRow(selected)

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Hide the columns that do not fit."""
        super().resizeEvent(event)
        self._choose_columns()

    def _choose_columns(self) -> None:
        letter = QFontMetrics(font()).averageCharWidth()
        left = self.width() - CHARACTERS[0] * letter
        for column in IMPORTANCE:
            left -= CHARACTERS[column] * letter
            self.table.setColumnHidden(column, left < 0)

    def _chosen(self, now: QModelIndex) -> None:
        if now.isValid():
            self.selected.emit(now.row())


def _cell(row: RobotRow, column: int) -> str:
    match column:
        case 0:
            return f"{row.name}\n{'! ' if row.trouble else ''}{row.state}"
        case 1:
            return "" if row.error is None else f"{row.error:.3f}"
        case 2:
            return "" if row.sigma is None else f"{row.sigma:.3f}"
        case 3:
            return "" if row.energy is None else f"{row.energy:g}"
        case _:
            return "" if row.speed is None else f"{row.speed:.2f}"
