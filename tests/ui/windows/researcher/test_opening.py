"""What is opened from the researcher's windows: by the dialog, from the list of recent ones, dropped on a window."""

import gc
from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QMimeData, QPoint, QPointF, QSettings, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot
from shiboken6 import isValid

from tests.support.hunts.recorded_hunts import record_beginning
from tests.support.windows.preferences import preferred
from ui.windows.researcher.memory import RECENT, WatchMemory
from ui.windows.researcher.show import WatchProgram


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return record_beginning(tmp_path_factory.mktemp("opened") / "hunt.bag", robots=1, seconds=0.5)


@pytest.fixture
def memory(tmp_path: Path) -> WatchMemory:
    return WatchMemory(QSettings(str(tmp_path / "windows.ini"), QSettings.Format.IniFormat))


@pytest.fixture
def program(qapp: QApplication, tmp_path: Path, memory: WatchMemory) -> Iterator[WatchProgram]:
    made = WatchProgram(qapp, preferred(qapp, tmp_path), memory)
    yield made
    for window in tuple(made.windows):
        window.close()


def test_the_dialog_opens_a_recording_and_remembers_it(program: WatchProgram, bag: Path, qtbot: QtBot) -> None:
    program.ask(None)
    dialog = program.dialog
    assert dialog is not None and not dialog.agree.isEnabled()
    dialog.source.setText(str(bag))
    qtbot.mouseClick(dialog.agree, Qt.MouseButton.LeftButton)
    assert not dialog.isVisible()
    (window,) = program.windows
    assert window.windowTitle().startswith("hunt.bag")
    with qtbot.waitActive(window):
        window.activateWindow()
    qtbot.keyClick(window, "o", Qt.KeyboardModifier.ControlModifier)
    assert program.dialog is not dialog
    assert program.dialog.recent.item(0).text() == str(bag)
    program.dialog.recent.setCurrentRow(0)
    assert program.dialog.source.text() == str(bag)
    program.dialog.close()


def test_a_session_opens_by_its_address_and_is_remembered(program: WatchProgram, memory: WatchMemory) -> None:
    assert program.open("127.0.0.1:1") == ""
    assert memory.recent() == ["127.0.0.1:1"]
    program.windows[0].refresh()
    assert "Connecting" in program.windows[0].sign.text() or "No answer" in program.windows[0].sign.text()


def test_bookmarks_are_kept_with_their_recording(program: WatchProgram, bag: Path, qtbot: QtBot) -> None:
    for times in ((), (0.0,)):
        program.open(str(bag))
        window = program.windows[-1]
        qtbot.waitUntil(lambda window=window: window.scene is not None)
        assert window.bookmarks.times == times
        window.bookmark_toggled.emit()
        window.close()


def test_the_dialog_stays_and_says_what_is_wrong(program: WatchProgram, tmp_path: Path, qtbot: QtBot) -> None:
    (tmp_path / "none.bag").write_text("this is no bag, whatever it is called")
    program.ask(None)
    dialog = program.dialog
    assert dialog is not None
    for source, problem in ((tmp_path / "none.bag", "not a ROS 1 bag"), ("localhost:99999", "99999 is not a port")):
        dialog.source.setText(str(source))
        qtbot.mouseClick(dialog.agree, Qt.MouseButton.LeftButton)
        assert dialog.isVisible() and problem in dialog.fault.text()
    assert program.windows == []
    dialog.close()


def test_a_bag_dropped_on_the_map_opens_beside(program: WatchProgram, bag: Path, qtbot: QtBot) -> None:
    assert program.open(str(bag)) == ""
    window = program.windows[0]
    for under in (window.canvas, window.plots.canvas.viewport(), window.team.table.viewport()):
        takes: QWidget | None = under
        while takes is not None and not takes.acceptDrops():
            takes = takes.parentWidget()
        assert takes is window
    files = QMimeData()
    files.setUrls([QUrl.fromLocalFile(str(bag))])
    copy, left, none = Qt.DropAction.CopyAction, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier
    enter = QDragEnterEvent(QPoint(50, 50), copy, files, left, none)
    QApplication.sendEvent(window, enter)
    assert enter.isAccepted()
    QApplication.sendEvent(window, QDropEvent(QPointF(50, 50), copy, files, left, none))
    assert [each.windowTitle() for each in program.windows] == [window.windowTitle()] * 2


def test_only_the_latest_recordings_are_remembered_with_their_bookmarks(memory: WatchMemory) -> None:
    for number in range(RECENT + 2):
        memory.add(f"/{number}.bag")
        memory.keep_bookmarks(f"/{number}.bag", [float(number)])
    memory.add("/5.bag")
    assert memory.recent() == [f"/{number}.bag" for number in (5, 11, 10, 9, 8, 7, 6, 4, 3, 2)]
    assert memory.bookmarks("/5.bag") == [5.0]
    assert memory.bookmarks("/1.bag") == []


@pytest.mark.parametrize("live", [False, True])
def test_a_window_that_is_closed_is_freed_with_all_its_parts(
    program: WatchProgram, bag: Path, qtbot: QtBot, live: bool
) -> None:
    assert QApplication.allWidgets() == []
    program.open("127.0.0.1:1" if live else str(bag))
    shown = list(program.windows)
    shown[0].close()
    assert program.windows == []
    qtbot.waitUntil(lambda: not isValid(shown[0]))
    shown.clear()
    gc.collect()
    assert QApplication.allWidgets() == []
