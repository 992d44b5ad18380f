"""Main window for drawing an arena: the map on the left, rooms and start poses as a list on the right."""

from collections.abc import Callable
from functools import partial
from itertools import pairwise

import numpy as np
import pyqtgraph as pg
from PySide6.QtCore import QEvent, QObject, QSignalBlocker, QSize, Qt, QTimer, Slot
from PySide6.QtGui import QCloseEvent, QKeyEvent, QKeySequence, QShortcut
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHBoxLayout,
    QListWidget,
    QListWidgetItem,
    QMainWindow,
    QMessageBox,
    QPushButton,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from sim.common.grid import OccupancyGrid
from sim.common.traversability import Mask
from thbridge.files.map_files import FOOTPRINT
from thbridge.hunt.refusals import RequestRefused
from thbridge.offline.arena import Arena
from thbridge.roles.keeper.disclosed.floor_plan import floor_plan_of
from ui.model.arena.draft import ArenaDraft, ArenaPointer, ArenaTool
from ui.model.shared.scene import RobotMark, RoomMark
from ui.windows.arena.marks import ArenaMarks
from ui.windows.look import GAP, FoldingRow, colours, label, open_within_screen, px, spaced
from ui.windows.map import MapView
from ui.windows.map.item import CellImage
from ui.windows.untrusted_text import title_text

REACH = 12.0
"""Distance in pixels. A press within this distance of a goal, corner or start pose grabs this point."""
STEP = 0.1
"""Distance by which a key moves the chosen goal or start pose, meters."""
TURN = np.pi / 12
"""Angle by which a key turns the chosen goal or start pose, radians."""
ARROWS = {
    Qt.Key.Key_Left: (-STEP, 0.0),
    Qt.Key.Key_Right: (STEP, 0.0),
    Qt.Key.Key_Up: (0.0, STEP),
    Qt.Key.Key_Down: (0.0, -STEP),
}
TOOLS = {
    ArenaTool.MOVE: ("Move", "V", "Click a room to select it. Drag goals, start poses or corners to move them."),
    ArenaTool.ROOM: (
        "Draw room",
        "R",
        "Drag a box. The free floor in the box becomes a room, except parts of other rooms.",
    ),
    ArenaTool.CUT: ("Cut room", "C", "Drag a line across a room to divide the room into two."),
    ArenaTool.START: ("Add start", "S", "Click the place where another robot should start."),
}
HELP = (
    "In the list: F2 renames an entry, Del deletes it, Ctrl+M merges two selected rooms, Ctrl+Up or Ctrl+Down changes "
    "a room's number. Alt+arrow keys move the selected goal or start pose. Alt+Page Up or Alt+Page Down turns it."
)


class ArenaWindow(QMainWindow):
    """Window for drawing an arena.

    Args:
        name: name of the map.
        grid: cells of the map.
        arena: rooms and start poses to start with.
        write: function that writes the arena. It returns the reason for a failure, or None.
        is_saved: True if `arena` is already saved in a file.
        left_out: (rows, cols) True for cells of removed lines, which the window shows. None if no lines were removed.
    """

    def __init__(
        self,
        name: str,
        grid: OccupancyGrid,
        arena: Arena,
        write: Callable[[Arena], str | None],
        *,
        is_saved: bool = False,
        left_out: Mask | None = None,
    ) -> None:
        super().__init__()
        self._left_out = left_out
        self._lines = CellImage()
        self.draft = ArenaDraft(grid, arena, is_saved=is_saved)
        self.pointer = ArenaPointer(self.draft)
        self._write = write
        self._name = name
        self.map = MapView(colours(), axes=True)
        self.map.show_floor_plan(floor_plan_of(name, grid, (), FOOTPRINT))
        self.map.box.addItem(self._lines, ignoreBounds=True)
        self._show_left_out()
        self._marks = ArenaMarks(self.map.box, self.pointer)
        self.list = QListWidget()
        self.list.setAccessibleName("Rooms and start poses")
        self.list.setSelectionMode(QAbstractItemView.SelectionMode.ExtendedSelection)
        self.list.setEditTriggers(
            QAbstractItemView.EditTrigger.EditKeyPressed | QAbstractItemView.EditTrigger.DoubleClicked
        )
        self.list.installEventFilter(self)
        self.told = label("", bold=True)
        self._hint = label("", "small", muted=True)
        self._buttons: dict[str, QPushButton] = {}
        self._lay_out()
        self._connect()
        self.take_tool(ArenaTool.MOVE)
        self.setWindowTitle(f"{title_text(name)}[*] — arena")
        open_within_screen(self, QSize(1240, 860))
        self.list.setFocus()

    # Contents ---------------------------------------------------------------------------------------------------------

    @Slot()
    def show_all(self) -> None:
        """Update everything that is visible."""
        arena, pointer = self.pointer.shown, self.pointer
        self.map.show_rooms(
            [
                RoomMark(
                    room.room.people,
                    room.name,
                    np.array(room.region),
                    "unvisited",
                    considered=room.room.people == pointer.chosen,
                )
                for room in arena.rooms
            ]
        )
        nothing = np.empty((0, 2))
        self.map.show_robots(
            [
                RobotMark(
                    index, str(index + 1), start, np.array(FOOTPRINT), index == pointer.start, False, nothing, nothing
                )
                for index, start in enumerate(arena.starts)
            ]
        )
        self._marks.update()
        self._show_list()
        faults = self.draft.floor.faults(self.draft.arena)
        self.told.setText(pointer.refusal or (faults[0] if faults else ""))
        self.told.setVisible(bool(self.told.text()))
        self._buttons["undo"].setEnabled(self.draft.can_undo)
        self._buttons["redo"].setEnabled(self.draft.can_redo)
        self._buttons["merge"].setEnabled(len(self._chosen_rooms()) == 2)
        self._buttons["delete"].setEnabled(pointer.handle is not None)
        self._buttons["save"].setEnabled(self.draft.dirty)
        self.setWindowModified(self.draft.dirty)

    @Slot()
    def repaint_all(self) -> None:
        """Show the window in the current colors."""
        self.map.set_palette(colours())
        self._show_left_out()
        self.show_all()

    def _show_left_out(self) -> None:
        """Show the removed lines of the map in the accent color, so that people notice missing walls."""
        grid = self.draft.floor.map.grid
        if self._left_out is not None:
            table = np.zeros((256, 4), dtype=np.uint8)
            table[1] = pg.mkColor(colours().accent).getRgb()
            self._lines.show_cells(self._left_out.astype(np.uint8), table, grid.origin, grid.resolution)

    def take_tool(self, tool: ArenaTool) -> None:
        """Select another tool."""
        self.pointer.tool = tool
        for other in ArenaTool:
            self._buttons[other.value].setChecked(other is tool)
        self._hint.setText(f"{TOOLS[tool][2]} {HELP}")
        self.map.set_tool(Qt.CursorShape.ArrowCursor if tool is ArenaTool.MOVE else Qt.CursorShape.CrossCursor)
        self.show_all()

    def _show_list(self) -> None:
        """List the rooms, then the start poses; keep the selection."""
        arena = self.draft.arena
        lines = [f"{room.room.people}  {room.name}" for room in arena.rooms]
        lines += [f"Start of robot {number}" for number in range(1, len(arena.starts) + 1)]
        with QSignalBlocker(self.list):
            if lines != [self.list.item(row).text() for row in range(self.list.count())]:
                self.list.clear()
                for row, line in enumerate(lines):
                    item = QListWidgetItem(line, self.list)
                    if row < len(arena.rooms):
                        item.setFlags(item.flags() | Qt.ItemFlag.ItemIsEditable)
            chosen = self._row_of_chosen()
            if chosen is None:
                self.list.clearSelection()
            elif chosen not in self._chosen_rows():
                self.list.setCurrentRow(chosen)

    def _row_of_chosen(self) -> int | None:
        handle = self.pointer.handle
        if handle is None:
            return None
        return len(self.draft.arena.rooms) + handle.index if handle.is_start else handle.room - 1

    def _chosen_rows(self) -> list[int]:
        return sorted(self.list.row(item) for item in self.list.selectedItems())

    def _chosen_rooms(self) -> list[int]:
        return [row + 1 for row in self._chosen_rows() if row < len(self.draft.arena.rooms)]

    # Changes ----------------------------------------------------------------------------------------------------------

    def change(self, made: Callable[[], RequestRefused | None]) -> None:
        """Change the draft, and show the result."""
        self.pointer.change(made)
        self.show_all()

    @Slot()
    def undo(self) -> None:
        """Undo the last change."""
        self.change(self.draft.undo)

    @Slot()
    def redo(self) -> None:
        """Redo the change that was undone."""
        self.change(self.draft.redo)

    @Slot()
    def merge(self) -> None:
        """Merge the two rooms that are selected in the list."""
        rooms = self._chosen_rooms()
        if len(rooms) == 2:
            self.pointer.choose(rooms[0])
            self.change(lambda: self.draft.merge_rooms(*rooms))

    @Slot()
    def delete(self) -> None:
        """Delete the selected room or start pose."""
        handle = self.pointer.handle
        if handle is not None and handle.is_start:
            self.change(lambda: self.draft.remove_start(handle.index))
        elif handle is not None:
            self.change(lambda: self.draft.remove_room(handle.room))

    @Slot()
    def save(self) -> bool:
        """Write the arena. Return True if it was written."""
        faults = self.draft.floor.faults(self.draft.arena)
        refused = self._write(self.draft.arena) if not faults else f"Not saved: {faults[0]}"
        if refused is None:
            self.draft.saved()
        self.pointer.refusal = refused or ""
        self.show_all()
        return refused is None

    def _renumber(self, step: int) -> None:
        room = self.pointer.chosen
        if room is not None:
            wanted = room + step
            self.pointer.choose(wanted if 1 <= wanted <= len(self.draft.arena.rooms) else room)
            self.change(lambda: self.draft.renumber(room, wanted))

    def _nudge(self, dx: float, dy: float) -> None:
        handle = self.pointer.handle
        if handle is not None:
            arena = self.draft.arena
            pose = arena.starts[handle.index] if handle.is_start else arena.rooms[handle.room - 1].goal
            self.change(lambda: self.draft.move(handle, pose.x + dx, pose.y + dy))

    def _turn(self, angle: float) -> None:
        handle = self.pointer.handle
        if handle is not None:
            self.change(lambda: self.draft.turn(handle, angle))

    # Events -----------------------------------------------------------------------------------------------------------

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Handle the keys in the list that change the selected room or start pose."""
        if watched is self.list and event.type() == QEvent.Type.KeyPress and isinstance(event, QKeyEvent):
            key, held = Qt.Key(event.key()), event.modifiers() & ~Qt.KeyboardModifier.KeypadModifier
            if held == Qt.KeyboardModifier.AltModifier and key in ARROWS:
                self._nudge(*ARROWS[key])
                return True
            if held == Qt.KeyboardModifier.AltModifier and key in (Qt.Key.Key_PageUp, Qt.Key.Key_PageDown):
                self._turn(TURN if key == Qt.Key.Key_PageUp else -TURN)
                return True
            if held == Qt.KeyboardModifier.ControlModifier and key in (Qt.Key.Key_Up, Qt.Key.Key_Down):
                self._renumber(-1 if key == Qt.Key.Key_Up else 1)
                return True
        return super().eventFilter(watched, event)

    def closeEvent(self, event: QCloseEvent) -> None:
        """Ask for confirmation if changes would be lost."""
        if self.draft.dirty:
            box = QMessageBox(QMessageBox.Icon.Question, self._name, "Save the arena?", parent=self)
            box.setObjectName("question")
            standard = QMessageBox.StandardButton
            box.setStandardButtons(standard.Save | standard.Discard | standard.Cancel)
            chosen = box.exec()
            if chosen == standard.Cancel or (chosen == standard.Save and not self.save()):
                event.ignore()
                return
        super().closeEvent(event)

    @Slot(float, float)
    def _pressed(self, x: float, y: float) -> None:
        self.pointer.press(x, y, self.map.metres(REACH))
        self.show_all()

    @Slot(float, float)
    def _dragged(self, x: float, y: float) -> None:
        self.pointer.drag(x, y)
        self.show_all()

    @Slot(float, float)
    def _released(self, _x: float, _y: float) -> None:
        self.pointer.release()
        self.show_all()

    @Slot()
    def _selected(self) -> None:
        row, rooms = self.list.currentRow(), len(self.draft.arena.rooms)
        if row < 0:
            self.pointer.choose(None)
        else:
            self.pointer.choose(row + 1 if row < rooms else None, row - rooms if row >= rooms else None)
        self.show_all()

    @Slot(QListWidgetItem)
    def _renamed(self, item: QListWidgetItem) -> None:
        number, text = self.list.row(item) + 1, item.text()
        name = text.removeprefix(f"{number}  ")
        # Wait until the event is handled: refilling the list now would destroy its open editor.
        QTimer.singleShot(0, self, lambda: self.change(lambda: self.draft.rename(number, name)))

    # Layout -----------------------------------------------------------------------------------------------------------

    def _lay_out(self) -> None:
        tools, acts = spaced(QHBoxLayout(), GAP), spaced(QHBoxLayout(), GAP)
        for tool, (words, key, meaning) in TOOLS.items():
            tools.addWidget(self._made_button(tool.value, words, key, partial(self.take_tool, tool), meaning))
            self._buttons[tool.value].setCheckable(True)
        tools.addStretch(1)
        for name, words, key, slot in (
            ("merge", "Merge", "Ctrl+M", self.merge),
            ("delete", "Delete", "Del", self.delete),
            ("undo", "Undo", "Ctrl+Z", self.undo),
            ("redo", "Redo", "Ctrl+Shift+Z", self.redo),
            ("save", "Save", "Ctrl+S", self.save),
        ):
            acts.addWidget(self._made_button(name, words, key, slot, words))
        body = QSplitter(Qt.Orientation.Horizontal)
        body.setChildrenCollapsible(False)
        body.addWidget(self.map)
        body.addWidget(self.list)
        body.setStretchFactor(0, 1)
        body.setSizes([px(960), px(260)])
        inside = QWidget()
        column = spaced(QVBoxLayout(inside), GAP, 2 * GAP, 2 * GAP, 2 * GAP, GAP)
        column.addWidget(FoldingRow(tools, acts))
        column.addWidget(body, 1)
        column.addWidget(self.told)
        column.addWidget(self._hint)
        self.setCentralWidget(inside)
        for before, after in pairwise([*self._buttons.values(), self.list]):
            self.setTabOrder(before, after)

    def _made_button(self, name: str, words: str, key: str, act: Callable[[], object], meaning: str) -> QPushButton:
        button = QPushButton(words)
        button.setToolTip(f"{meaning} ({key})")
        button.setAccessibleDescription(f"Shortcut: {key}")
        button.clicked.connect(lambda _checked=False: act())
        QShortcut(QKeySequence(key), self).activated.connect(act)
        self._buttons[name] = button
        return button

    def _connect(self) -> None:
        self.map.point_pressed.connect(self._pressed)
        self.map.point_dragged.connect(self._dragged)
        self.map.point_released.connect(self._released)
        self.list.itemSelectionChanged.connect(self._selected)
        self.list.itemChanged.connect(self._renamed)
