"""A person who plays a hunt in the participant's window."""

from dataclasses import dataclass, field

from PySide6.QtCore import QPoint, Qt
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.hunts.screen_player import ScreenPlayer
from tests.support.windows.participant_windows import press, that_asks
from ui.model.playing.screen import Act
from ui.windows.participant import ParticipantWindow

LEFT = Qt.MouseButton.LeftButton


@dataclass
class WindowPlayer:
    """A person at the window; each act is drawn before the game goes on.

    Attributes:
        views: every place that the map had in the window, and every view of it, as long as it was shown.
    """

    seat: ScreenPlayer
    window: ParticipantWindow
    qtbot: QtBot
    views: set[str] = field(default_factory=set)

    def wait(self, ticks: int = 20) -> None:
        self.look()
        self.seat.run(ticks)
        self.window.refresh()
        self.look()

    def look(self) -> None:
        QApplication.processEvents()
        shown = self.window.map
        if shown.isVisible():
            corners = [shown.pixel(x, y) for x, y in ((0.0, 0.0), (1.0, 1.0))]
            self.views.add(str((shown.mapTo(self.window, QPoint(0, 0)), shown.size(), corners)))

    def click(self, act: Act) -> None:
        self.qtbot.mouseClick(that_asks(self.window, act), LEFT)
        self.wait()

    def key(self, key: str) -> None:
        press(self.qtbot, self.window, key)
        self.wait()
