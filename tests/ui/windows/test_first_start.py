"""The window of the first start: how far it is, for how long, and Cancel."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QApplication, QScrollArea
from pytestqt.qtbot import QtBot

from ui.windows import look
from ui.windows.first_start import FirstStartWindow


@pytest.fixture
def window(qtbot: QtBot) -> FirstStartWindow:
    made = FirstStartWindow()
    qtbot.addWidget(made)
    made.show()
    return made


def test_before_anything_is_compiled_it_shows_seconds_and_that_it_is_busy(window: FirstStartWindow) -> None:
    assert window.state.text() == "0 s"
    assert (window.bar.minimum(), window.bar.maximum()) == (0, 0)


def test_it_shows_how_much_of_all_is_compiled(window: FirstStartWindow) -> None:
    window.received.emit(34, 123)
    assert (window.bar.value(), window.bar.maximum()) == (34, 123)
    assert window.state.text().startswith("Compiled 34 of 123, ")


def test_seconds_become_minutes(window: FirstStartWindow, monkeypatch: pytest.MonkeyPatch) -> None:
    window._began -= 130
    window.show_progress(1, 2)
    assert window.state.text().startswith("Compiled 1 of 2, 2 min 1")


@pytest.mark.parametrize("how", ["click", "Escape", "close"])
def test_cancel_is_said_once(window: FirstStartWindow, qtbot: QtBot, how: str) -> None:
    with qtbot.waitSignal(window.cancelled):
        if how == "click":
            qtbot.mouseClick(window.cancel, Qt.MouseButton.LeftButton)
        elif how == "Escape":
            window.activateWindow()
            qtbot.keyClick(window, Qt.Key.Key_Escape)
        else:
            window.close()
    assert not window.isVisible()


def test_the_program_closes_it_without_cancelling(window: FirstStartWindow, qtbot: QtBot) -> None:
    with qtbot.assertNotEmitted(window.cancelled):
        window.ended.emit()
    assert not window.isVisible()


def test_with_large_text_in_little_room_nothing_is_cut_off(qapp: QApplication, qtbot: QtBot) -> None:
    look.apply_text_size(qapp, 2.0)
    try:
        window = FirstStartWindow()
        qtbot.addWidget(window)
        window.resize(240, 120)
        window.show()
        (area,) = window.findChildren(QScrollArea)
        qtbot.waitUntil(lambda: area.verticalScrollBar().maximum() > 0)
        assert window.rect().contains(window.cancel.geometry())
        assert window.cancel.width() >= window.cancel.sizeHint().width()
    finally:
        look.apply_text_size(qapp, 1.0)
