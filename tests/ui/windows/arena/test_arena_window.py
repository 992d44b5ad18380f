from pathlib import Path

import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QApplication, QLineEdit
from pytestqt.qtbot import QtBot

from tests.support.maps.small_arenas import FOUND
from tests.support.windows.questions import answering
from tests.support.windows.screen_reader import against_the_eye, nameless, stops
from thbridge.files.map_files import check_map, read_map
from ui.model.shared.theme import DARK
from ui.windows.arena.window import ArenaWindow
from ui.windows.look import apply_palette


def pixel(window: ArenaWindow, x: float, y: float) -> QPoint:
    return window.map.pixel(x, y).toPoint()


def stroke(qtbot: QtBot, window: ArenaWindow, one: tuple[float, float], other: tuple[float, float]) -> None:
    qtbot.mousePress(window.map.viewport(), Qt.MouseButton.LeftButton, pos=pixel(window, *one))
    qtbot.mouseMove(window.map.viewport(), pixel(window, *other))
    qtbot.mouseRelease(window.map.viewport(), Qt.MouseButton.LeftButton, pos=pixel(window, *other))


def lines(window: ArenaWindow) -> list[str]:
    return [window.list.item(row).text() for row in range(window.list.count())]


def test_a_room_is_cut_by_a_line_and_saved_as_a_map_that_loads(qtbot: QtBot, window: ArenaWindow, folder: Path) -> None:
    qtbot.keyClick(window, Qt.Key.Key_C)
    stroke(qtbot, window, (4.5, 5.0), (7.5, 5.0))
    assert lines(window)[:4] == ["1  West", "2  Middle", "3  East", "4  Room 4"]
    assert window.isWindowModified()
    qtbot.keyClick(window, Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
    assert not window.isWindowModified()
    assert [room.name for room in read_map(folder).rooms] == ["West", "Middle", "East", "Room 4"]


def test_a_start_pose_is_dragged_and_comes_back_by_undo(qtbot: QtBot, window: ArenaWindow) -> None:
    start = FOUND.starts[0]
    stroke(qtbot, window, (start.x, start.y), (11.0, 1.0))
    assert window.draft.arena.starts[0].x == pytest.approx(11.0, abs=0.05)
    assert window.list.currentItem().text() == "Start of robot 1"
    qtbot.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert window.draft.arena == FOUND
    qtbot.keyClick(window, Qt.Key.Key_Z, Qt.KeyboardModifier.ControlModifier | Qt.KeyboardModifier.ShiftModifier)
    assert window.draft.arena.starts[0].x == pytest.approx(11.0, abs=0.05)


def test_where_no_robot_can_stand_is_told_and_nothing_moves(qtbot: QtBot, window: ArenaWindow) -> None:
    start = FOUND.starts[0]
    stroke(qtbot, window, (start.x, start.y), (start.x, 0.1))
    assert window.draft.arena == FOUND
    qtbot.mousePress(window.map.viewport(), Qt.MouseButton.LeftButton, pos=pixel(window, start.x, start.y))
    qtbot.mouseMove(window.map.viewport(), pixel(window, start.x, 0.1))
    assert "A robot cannot turn there" in window.told.text()
    assert window.told.isVisible()
    qtbot.mouseRelease(window.map.viewport(), Qt.MouseButton.LeftButton, pos=pixel(window, start.x, 0.1))


def test_everything_is_done_by_keys(qtbot: QtBot, window: ArenaWindow) -> None:
    window.list.setCurrentRow(1)
    qtbot.keyClick(window.list, Qt.Key.Key_F2)
    line = window.list.findChild(QLineEdit)
    line.selectAll()
    qtbot.keyClicks(line, "Server room")
    qtbot.keyClick(line, Qt.Key.Key_Return)
    qtbot.waitUntil(lambda: window.draft.arena.rooms[1].name == "Server room")
    assert lines(window)[1] == "2  Server room"
    control, alt = Qt.KeyboardModifier.ControlModifier, Qt.KeyboardModifier.AltModifier
    qtbot.keyClick(window.list, Qt.Key.Key_Up, control)
    assert lines(window)[:2] == ["1  Server room", "2  West"]
    before = window.draft.arena.rooms[0].goal
    qtbot.keyClick(window.list, Qt.Key.Key_Right, alt)
    qtbot.keyClick(window.list, Qt.Key.Key_PageUp, alt)
    after = window.draft.arena.rooms[0].goal
    assert (after.x, after.theta) == (pytest.approx(before.x + 0.1), pytest.approx(0.262, abs=0.001))
    qtbot.keyClick(window.list, Qt.Key.Key_Down, Qt.KeyboardModifier.ShiftModifier)
    qtbot.keyClick(window, Qt.Key.Key_M, control)
    assert lines(window)[:2] == ["1  Server room", "2  East"]
    window.list.setCurrentRow(3)
    qtbot.keyClick(window, Qt.Key.Key_Delete)
    assert len(window.draft.arena.starts) == len(FOUND.starts) - 1


def test_a_drawn_room_is_the_floor_between_walls(qtbot: QtBot, window: ArenaWindow) -> None:
    window.list.setCurrentRow(2)
    qtbot.keyClick(window, Qt.Key.Key_Delete)
    assert lines(window)[:3] == ["1  West", "2  Middle", "Start of robot 1"]
    qtbot.keyClick(window, Qt.Key.Key_R)
    stroke(qtbot, window, (7.5, 2.15), (11.95, 7.95))
    assert lines(window)[2] == "3  Room 3"
    assert window.list.currentItem().text() == "3  Room 3"


def test_closing_asks_while_something_is_unsaved(qtbot: QtBot, window: ArenaWindow, folder: Path) -> None:
    with answering("Cancel") as asked:
        window.close()
    assert asked
    assert window.isVisible()
    with answering("Save"):
        window.close()
    assert not window.isVisible()
    assert check_map(folder).errors == ()


def test_an_arena_on_which_nobody_can_play_is_not_saved(qtbot: QtBot, window: ArenaWindow, folder: Path) -> None:
    for _ in FOUND.starts:
        window.list.setCurrentRow(3)
        qtbot.keyClick(window, Qt.Key.Key_Delete)
    qtbot.keyClick(window, Qt.Key.Key_S, Qt.KeyboardModifier.ControlModifier)
    assert window.told.text() == "Not saved: There is no start pose yet."
    assert not (folder / "rooms.yaml").exists()


def test_names_for_screen_readers_and_the_order_of_tab(window: ArenaWindow, qapp: QApplication) -> None:
    assert nameless(window) == []
    assert against_the_eye(stops(window), window) == []
    apply_palette(qapp, DARK)
    window.repaint_all()
    assert window.map.box.colors is DARK
