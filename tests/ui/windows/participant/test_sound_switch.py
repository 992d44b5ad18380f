"""M switches the sound of the window off and on, for later games too."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings
from pytestqt.qtbot import QtBot

from tests.ui.windows.participant.test_leaving import ArrivedLink, Table, at_table
from tests.ui.windows.participant.test_window import press
from ui.model.screen import SwitchSound
from ui.windows import participant_program
from ui.windows.participant.widgets.buttons import ActionButton

__all__ = ["at_table"]


def kept_sound(folder: Path) -> object:
    """The choice that is kept for the next program."""
    return QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat).value("sound")


def switch(table: Table) -> str:
    """The label of the switch in the game that is shown; empty before it is."""
    assert table.window is not None and table.window.game is not None
    buttons = table.window.game.window_of_game.findChildren(ActionButton)
    return next((button.face.label for button in buttons if button.act == SwitchSound() and button.face), "")


def test_m_mutes_this_game_and_the_next(
    at_table: Callable[[bool], Table], qtbot: QtBot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(participant_program, "system_player", lambda: (sys.executable, "-c", "pass"))
    table = at_table(True)
    assert table.window is not None and table.window.game is not None
    qtbot.waitUntil(lambda: switch(table) == "Mute")
    press(qtbot, table.window.game.window_of_game, "M")
    qtbot.waitUntil(lambda: kept_sound(tmp_path) == "false")
    assert switch(table) == "Unmute"
    table.window.join(ArrivedLink())
    qtbot.waitUntil(lambda: switch(table) != "")
    assert switch(table) == "Unmute"
