"""Preferences: light or dark, size of text, sound and place of a window, for each kind of window by itself."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from PySide6.QtCore import QRect, Qt
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QApplication, QMessageBox, QPushButton, QVBoxLayout, QWidget
from pytestqt.qtbot import QtBot

from tests.support.windows.preferences import preferred
from thbridge.files.language_texts import shipped_texts
from ui.model.shared.theme import DARK, LIGHT
from ui.windows import look
from ui.windows.preferences import SettingsDialog


@pytest.fixture(autouse=True)
def as_usual(qapp: QApplication) -> Iterator[None]:
    yield
    look.apply_text_size(qapp, 1.0)
    look.apply_palette(qapp, LIGHT)


@pytest.fixture
def window(qtbot: QtBot) -> QWidget:
    made = QWidget()
    qtbot.addWidget(made)
    rows = QVBoxLayout(made)
    rows.addWidget(look.label("Room 4", "title"))
    rows.addWidget(QPushButton("Reset"))
    return made


def shown(qtbot: QtBot, window: QWidget) -> None:
    with qtbot.waitActive(window):
        window.show()
        window.activateWindow()


def test_a_choice_counts_at_once_and_for_the_next_program(qapp: QApplication, qtbot: QtBot, tmp_path: Path) -> None:
    preferences = preferred(qapp, tmp_path, "system")
    with qtbot.waitSignal(preferences.changed) as told:
        preferences.choose_look("dark")
    assert told.args == [DARK]
    assert qapp.palette().color(QPalette.ColorRole.Window).name() == DARK.window
    preferences.choose_text_size(125)
    preferences.choose_sound(False)
    later = preferred(qapp, tmp_path, "system")
    assert (later.look, later.percent, later.sound_on) == ("dark", 125, False)
    assert preferred(qapp, tmp_path, "light").look == "light", "an option of the command counts more"


def test_another_kind_of_window_does_not_follow(qapp: QApplication, tmp_path: Path) -> None:
    participant, researcher = preferred(qapp, tmp_path / "a"), preferred(qapp, tmp_path / "b")
    participant.choose_text_size(200)
    participant.choose_sound(False)
    assert (researcher.percent, researcher.sound_on) == (100, True)
    assert preferred(qapp, tmp_path / "b").percent == 100


def test_keys_make_text_larger_and_smaller(qtbot: QtBot, qapp: QApplication, tmp_path: Path, window: QWidget) -> None:
    preferred(qapp, tmp_path).add_keys(window)
    shown(qtbot, window)
    children = window.findChildren(QWidget)
    before = [child.font().pointSizeF() for child in children]

    def pressed(key: Qt.Key, times: int = 1) -> list[float]:
        for _ in range(times):
            qtbot.keyClick(window, key, Qt.KeyboardModifier.ControlModifier)
        return [child.font().pointSizeF() / was for child, was in zip(children, before, strict=True)]

    assert pressed(Qt.Key.Key_Plus) == pytest.approx([1.1, 1.1])
    assert pressed(Qt.Key.Key_Equal) == pytest.approx([1.25, 1.25]), "Plus without Shift on many keyboards"
    assert pressed(Qt.Key.Key_Plus, times=9) == pytest.approx([2.0, 2.0]), "the largest"
    assert pressed(Qt.Key.Key_0) == pytest.approx([1.0, 1.0])
    assert pressed(Qt.Key.Key_Minus, times=9) == pytest.approx([0.8, 0.8]), "the smallest"


@pytest.mark.parametrize("modal", [True, False])
def test_keys_choose_the_size_in_a_box_over_the_window_too(
    qtbot: QtBot, qapp: QApplication, tmp_path: Path, window: QWidget, modal: bool
) -> None:
    preferences = preferred(qapp, tmp_path)
    preferences.add_keys(window)
    shown(qtbot, window)

    def pressed_in_a_box() -> int:
        box = QMessageBox(QMessageBox.Icon.Question, "Robot 1", "Kill it?", parent=window.findChild(QPushButton))
        box.setModal(modal)
        box.show()
        box.activateWindow()
        qtbot.waitUntil(lambda: qapp.focusWindow() == box.windowHandle())
        qtbot.keyClick(box, Qt.Key.Key_Plus, Qt.KeyboardModifier.ControlModifier)
        box.close()
        window.activateWindow()
        qtbot.waitUntil(lambda: qapp.focusWindow() == window.windowHandle())
        return preferences.percent

    assert [pressed_in_a_box(), pressed_in_a_box()] == [110, 125]
    qtbot.keyClick(window, Qt.Key.Key_0, Qt.KeyboardModifier.ControlModifier)
    assert preferences.percent == 100


@pytest.mark.parametrize(("written", "percent"), [("x", 100), ("-5", 100), ("117", 110), ("9999", 200), ("", 100)])
def test_a_size_that_nobody_could_choose_does_no_harm(
    qapp: QApplication, tmp_path: Path, written: str, percent: int
) -> None:
    (tmp_path / "settings.ini").write_text(f"[General]\nlook=purple\n[text]\npercent={written}\n")
    preferences = preferred(qapp, tmp_path, "system")
    assert (preferences.percent, preferences.look) == (percent, "system")


def test_the_next_window_opens_where_the_last_one_was(qtbot: QtBot, qapp: QApplication, tmp_path: Path) -> None:
    first, place = QWidget(), QRect(60, 70, 500, 400)
    qtbot.addWidget(first)
    first.setGeometry(place)
    preferred(qapp, tmp_path).keep_place(first)
    first.show()
    first.close()
    later, second = preferred(qapp, tmp_path), QWidget()
    qtbot.addWidget(second)
    later.keep_place(second)
    second.show()
    assert second.geometry() == place
    third = QWidget()
    qtbot.addWidget(third)
    later.keep_place(third)
    assert third.geometry() != place, "the second is there still"


def test_the_page_of_settings(qtbot: QtBot, qapp: QApplication, tmp_path: Path, window: QWidget) -> None:
    preferences = preferred(qapp, tmp_path)
    preferences.texts = shipped_texts("de")
    preferences.add_keys(window)
    shown(qtbot, window)
    qtbot.keyClick(window, Qt.Key.Key_Comma, Qt.KeyboardModifier.ControlModifier)
    dialog = window.findChild(SettingsDialog)
    assert dialog is not None and dialog.isVisible() and dialog.windowTitle() == "Einstellungen"
    assert [dialog.look.itemText(at) for at in range(3)] == ["Wie am Computer eingestellt", "Hell", "Dunkel"]
    dialog.look.setFocus()
    qtbot.keyClick(dialog.look, Qt.Key.Key_End)
    assert preferences.look == "dark" and look.colours() is DARK
    qtbot.keyClick(dialog.text_size, Qt.Key.Key_End)
    assert preferences.percent == 200
    qtbot.keyClick(dialog.sound, Qt.Key.Key_Space)
    assert not preferences.sound_on
    qtbot.keyClick(dialog, Qt.Key.Key_Escape)
    assert not dialog.isVisible()


def test_windows_without_sound_do_not_offer_it(
    qtbot: QtBot, qapp: QApplication, tmp_path: Path, window: QWidget
) -> None:
    dialog = preferred(qapp, tmp_path, has_sound=False).open(window)
    assert dialog.sound.parent() is None
