"""A window on a sample, with a clock of its own."""

from collections.abc import Callable
from dataclasses import dataclass

import pytest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.windows import sample_screens
from thbridge.dialogue.wording.texts import Texts
from ui.model.playing.screen import Act, Screen
from ui.model.shared.theme import LIGHT
from ui.windows import look
from ui.windows.participant import ParticipantWindow


@dataclass
class Opened:
    """A window, its model, and its clock."""

    window: ParticipantWindow
    model: sample_screens.SampleModel
    now: float = 0.0

    def show(self, screen: Screen, after: float = 1.0) -> None:
        """Another screen, so many seconds later, and another second until it can be answered."""
        self.now += after
        self.model.shown = screen
        self.window.refresh()
        QApplication.processEvents()

    @property
    def done(self) -> list[Act]:
        return self.model.done


@pytest.fixture
def opened(qtbot: QtBot, qapp: QApplication) -> Callable[..., Opened]:
    """Opens a window on a screen."""

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
