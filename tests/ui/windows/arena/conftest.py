"""Three rooms in the window of an arena."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.maps.small_arenas import FOUND, GRID
from tests.support.windows.questions import answering
from thbridge.files.grid_files import write_grid
from thbridge.files.map_files import write_rooms
from thbridge.offline.arena import Arena
from ui.model.shared.theme import LIGHT
from ui.windows.arena.window import ArenaWindow
from ui.windows.look import apply_palette


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_grid(tmp_path / "three", GRID)
    return tmp_path / "three"


@pytest.fixture
def window(qtbot: QtBot, qapp: QApplication, folder: Path) -> Iterator[ArenaWindow]:
    apply_palette(qapp, LIGHT)

    def write(arena: Arena) -> str | None:
        write_rooms(folder, arena.rooms, arena.starts)
        return None

    window = ArenaWindow("three", GRID, FOUND, write)
    with qtbot.waitActive(window):
        window.show()
        window.activateWindow()
    yield window
    with answering("Discard"):
        window.close()
    window.deleteLater()
