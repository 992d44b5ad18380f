"""M switches the sound of the window off and on, for later games too."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from PySide6.QtCore import QSettings, Qt
from pytestqt.qtbot import QtBot

from tests.support.windows.participant_windows import press
from tests.ui.windows.participant.joined_window import ArrivedLink, JoinedWindow
from ui.model.playing.screen import ShowSettings
from ui.windows import participant_program
from ui.windows.participant.widgets.buttons import ActionButton
from ui.windows.preferences import SettingsDialog


def kept_sound(folder: Path) -> object:
    """The choice that is kept for the next program."""
    return QSettings(str(folder / "settings.ini"), QSettings.Format.IniFormat).value("sound")


def settings_button(table: JoinedWindow) -> ActionButton | None:
    """The button of the game that is shown; None before it is."""
    assert table.window is not None and table.window.game is not None
    buttons = table.window.game.window_of_game.findChildren(ActionButton)
    return next((button for button in buttons if button.act == ShowSettings() and button.isVisible()), None)


def test_m_and_the_settings_mute_this_game_and_the_next(
    at_table: Callable[[bool], JoinedWindow], qtbot: QtBot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(participant_program, "system_player", lambda: (sys.executable, "-c", "pass"))
    table = at_table(True)
    assert table.window is not None and table.window.game is not None
    qtbot.waitUntil(lambda: settings_button(table) is not None)
    press(qtbot, table.window.game.window_of_game, "M")
    qtbot.waitUntil(lambda: kept_sound(tmp_path) == "false")
    table.window.join(ArrivedLink())
    game = table.window.game
    qtbot.waitUntil(lambda: settings_button(table) is not None)
    qtbot.mouseClick(settings_button(table), Qt.MouseButton.LeftButton)
    dialog = game.findChild(SettingsDialog)
    assert dialog is not None and dialog.isVisible() and not dialog.sound.isChecked()
    qtbot.keyClick(dialog.sound, Qt.Key.Key_Space)
    qtbot.waitUntil(lambda: kept_sound(tmp_path) == "true")
    qtbot.keyClick(dialog, Qt.Key.Key_Escape)
    table.window.activateWindow()
    qtbot.waitUntil(table.window.isActiveWindow)
    press(qtbot, game.window_of_game, "M")
    qtbot.waitUntil(lambda: kept_sound(tmp_path) == "false")
