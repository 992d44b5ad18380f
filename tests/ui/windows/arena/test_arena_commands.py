import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import Qt, QTimer
from PySide6.QtWidgets import QApplication, QLineEdit
from pytestqt.qtbot import QtBot
from typer.testing import Result

from tests.support.disks.small_disk import SmallDisk, why_not
from tests.support.maps.small_arenas import FOUND, GRID
from tests.support.programs.commands import invoke
from thbridge.files.grid_files import write_grid
from thbridge.files.map_files import check_map, read_map, write_rooms
from ui.windows.arena.window import ArenaWindow

CONTROL = Qt.KeyboardModifier.ControlModifier


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A map with times, on a display that is there."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("ui.windows.display.INVISIBLE_PLATFORMS", set())
    monkeypatch.setenv("DISPLAY", ":0")
    write_grid(tmp_path / "three", GRID)
    write_rooms(tmp_path / "three", FOUND.rooms, FOUND.starts)
    (tmp_path / "three" / "mapTimes").write_text("4\n99 9 9 9\n99 99 9 9\n99 9 99 9\n99 9 9 99\n")
    return tmp_path / "three"


def run(act: Callable[[ArenaWindow], None], *words: str) -> Result:
    """Run a command; as soon as its window is there, act in it and close it."""

    def look() -> None:
        for window in QApplication.topLevelWidgets():
            if isinstance(window, ArenaWindow) and window.isActiveWindow():
                timer.stop()
                act(window)
                window.close()
                window.deleteLater()

    timer = QTimer(interval=20)
    timer.timeout.connect(look)
    timer.start()
    return invoke("maps", *words)


def test_other_rooms_put_the_times_aside(qtbot: QtBot, folder: Path) -> None:
    def delete_a_room(window: ArenaWindow) -> None:
        window.list.setCurrentRow(0)
        qtbot.keyClick(window, Qt.Key.Key_Delete)
        qtbot.keyClick(window, Qt.Key.Key_S, CONTROL)

    done = run(delete_a_room, "edit", "three")
    assert done.exit_code == 0, done.stderr
    assert "Their file was renamed to three/mapTimes.old" in done.stdout
    assert done.stdout.endswith("thbridge maps measure three --out three/mapTimes\n")
    assert [room.name for room in read_map(folder).rooms] == ["Middle", "East"]


def test_times_are_put_aside_with_the_save_and_come_back_with_their_trips(qtbot: QtBot, folder: Path) -> None:
    times, seen = folder / "mapTimes", []
    written = times.read_text()

    def delete_a_room_and_undo(window: ArenaWindow) -> None:
        window.list.setCurrentRow(0)
        for key, held in ((Qt.Key.Key_Delete, Qt.KeyboardModifier.NoModifier), (Qt.Key.Key_Z, CONTROL)):
            qtbot.keyClick(window, key, held)
            qtbot.keyClick(window, Qt.Key.Key_S, CONTROL)
            seen.append(times.exists())

    run(delete_a_room_and_undo, "edit", "three")
    assert seen == [False, True]
    assert times.read_text() == written


def test_another_name_keeps_the_times_and_closing_without_a_change_says_nothing(qtbot: QtBot, folder: Path) -> None:
    def rename(window: ArenaWindow) -> None:
        window.list.setCurrentRow(1)
        qtbot.keyClick(window.list, Qt.Key.Key_F2)
        line = window.list.findChild(QLineEdit)
        qtbot.keyClick(line, Qt.Key.Key_End)
        qtbot.keyClicks(line, " office")
        qtbot.keyClick(line, Qt.Key.Key_Return)
        qtbot.waitUntil(lambda: window.draft.dirty)
        qtbot.keyClick(window, Qt.Key.Key_S, CONTROL)

    write_rooms(folder, FOUND.rooms, FOUND.starts, language="en")
    (folder / "de").mkdir()
    (folder / "de" / "words.yaml").write_text("rooms: {Middle: Mitte}\n")
    assert run(lambda window: None, "edit", "three").stdout == ""
    told = run(rename, "edit", "three").stdout
    assert "Checked: 0 errors, 1 warnings" in told
    assert "no room has the name 'Middle'. The nearest name is Middle office." in " ".join(told.split())
    assert (folder / "mapTimes").exists()
    saved = read_map(folder)
    assert (saved.rooms[1].name, saved.language, saved.words) == ("Middle office", "en", {"de": {"Middle": "Mitte"}})


def test_what_is_drawn_is_written_when_it_is_saved_and_not_before(qtbot: QtBot, folder: Path) -> None:
    def cut(window: ArenaWindow) -> None:
        assert not Path("mine").exists()
        window.change(lambda: window.draft.cut_room((4.5, 5.0), (7.5, 5.0)))
        qtbot.keyClick(window, Qt.Key.Key_S, CONTROL)

    done = run(cut, "new", "three/map.yaml", "--to", "mine", "--draw", "--no-times")
    assert done.exit_code == 0, done.stderr
    assert len(read_map(Path("mine")).rooms) == 4
    assert check_map(Path("mine")).findings == ()


@pytest.mark.parametrize("full", [True, False], ids=["full", "read-only"])
def test_what_has_no_room_is_told_and_stays_drawn(qtbot: QtBot, folder: Path, full: bool) -> None:
    if (reason := why_not()) is not None:
        pytest.skip(reason)
    told, kept = [], []

    def save(window: ArenaWindow) -> None:
        qtbot.keyClick(window, Qt.Key.Key_S, CONTROL)
        told.append((window.pointer.refusal, window.isWindowModified()))

    def save_without_room_and_with(window: ArenaWindow) -> None:
        window.list.setCurrentRow(0)
        qtbot.keyClick(window, Qt.Key.Key_Delete)
        with disk.full() if full else disk.read_only():
            save(window)
            kept.append(files())
        save(window)

    def files() -> dict[Path, bytes]:
        return {path: path.read_bytes() for path in mine.iterdir()}

    with SmallDisk(folder.parent / "disk", 16 << 20) as disk:
        mine = Path(shutil.copytree(folder, disk.folder / "mine"))
        before = files()
        done = run(save_without_room_and_with, "edit", str(mine))
        assert [room.name for room in read_map(mine).rooms] == ["Middle", "East"]
    assert done.exit_code == 0, done.stderr
    assert kept == [before]
    why = "No space left on device" if full else "Read-only file system"
    (refusal, modified), saved = told
    assert refusal.startswith(f"{mine / 'rooms.yaml'}: it cannot be written ({why}).")
    assert modified
    assert saved == ("", False)
