"""Participant's window on sample screens, with a simulated clock."""

from collections.abc import Callable
from dataclasses import dataclass

import pytest
from PySide6.QtCore import QPoint, QRect, Qt
from PySide6.QtWidgets import QApplication, QWidget
from pytestqt.qtbot import QtBot

from tests.support.windows import sample_screens
from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import Act, Screen
from ui.model.shared.theme import LIGHT
from ui.windows import look
from ui.windows.participant import ParticipantWindow
from ui.windows.participant.widgets.buttons import ParticipantButton


@dataclass
class Opened:
    """Window, its model, and its clock."""

    window: ParticipantWindow
    model: sample_screens.SampleModel
    now: float = 0.0

    def show(self, screen: Screen, after: float = 1.0) -> None:
        """Show another screen `after` seconds later."""
        self.now += after
        self.model.shown = screen
        self.window.refresh()
        QApplication.processEvents()

    @property
    def done(self) -> list[Act]:
        return self.model.done


@pytest.fixture
def opened(qtbot: QtBot, qapp: QApplication) -> Callable[..., Opened]:
    """Return a function that opens a window on a screen."""

    def make(screen: Screen, width: int = 1024, height: int = 768, texts: Texts = sample_screens.ENGLISH) -> Opened:
        look.apply_palette(qapp, LIGHT)
        rooms = {8: "arena8", 12: "warehouse12"}[len(screen.tiles)]
        model = sample_screens.SampleModel(screen, sample_screens.floor_plan(rooms), texts=texts)
        made = Opened.__new__(Opened)
        made.model, made.now = model, 0.0
        made.window = ParticipantWindow(model, lambda: made.now, LIGHT)
        qtbot.addWidget(made.window)
        made.window.resize(width, height)
        with qtbot.waitExposed(made.window):
            made.window.show()
        made.window.activateWindow()
        qtbot.waitUntil(made.window.isActiveWindow)
        qapp.processEvents()
        made.now += 1.0
        return made

    return make


Open = Callable[..., Opened]
STATES = sample_screens.states()


def buttons(window: QWidget) -> list[ParticipantButton]:
    return [button for button in window.findChildren(ParticipantButton) if button.isVisible() and button.isEnabled()]


def that_asks(window: QWidget, act: Act) -> ParticipantButton:
    return next(button for button in buttons(window) if button.act == act)


def room_on_map(shown: Opened, room: int) -> QPoint:
    """Return the middle of a room on the map, in pixels."""
    corners = next(mark.region for mark in shown.model.rooms(0.0) if mark.room == room)
    return shown.window.map.pixel(*corners.mean(axis=0)).toPoint()


def press(qtbot: QtBot, window: QWidget, key: str) -> None:
    target = QApplication.focusWidget() or window
    *with_, last = key.split("+")
    modifiers = Qt.KeyboardModifier.NoModifier
    for one in with_:
        modifiers |= {"Shift": Qt.KeyboardModifier.ShiftModifier, "Ctrl": Qt.KeyboardModifier.ControlModifier}[one]
    code = {
        "Tab": Qt.Key.Key_Backtab if "Shift" in with_ else Qt.Key.Key_Tab,
        "Esc": Qt.Key.Key_Escape,
        "Return": Qt.Key.Key_Return,
        "Space": Qt.Key.Key_Space,
        "Down": Qt.Key.Key_Down,
        "Up": Qt.Key.Key_Up,
        "End": Qt.Key.Key_End,
        "Right": Qt.Key.Key_Right,
        "F1": Qt.Key.Key_F1,
        "F6": Qt.Key.Key_F6,
    }.get(last)
    qtbot.keyClick(target, code if code is not None else last.lower(), modifiers)


def covered(shown: Opened, panel: QWidget) -> QRect:
    """Return the rectangle of a panel, in pixels of the map."""
    return QRect(shown.window.map.mapFromGlobal(panel.mapToGlobal(QPoint(0, 0))), panel.size())
