"""Windows to picture, and the stories that bring them into their states."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import mkdtemp

from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QApplication, QWidget

from ui.model.shared.theme import Palette
from ui.windows.preferences import Preferences


def unkept_preferences() -> Preferences:
    """Return preferences for pictures, in a temporary file."""
    application = QApplication.instance()
    if not isinstance(application, QApplication):
        raise TypeError("windows need an application")
    file = Path(mkdtemp()) / "settings.ini"
    return Preferences(application, QSettings(str(file), QSettings.Format.IniFormat), "light")


def nothing(_palette: Palette) -> None:
    """Do nothing: for windows that follow the application's colors on their own."""


@dataclass(frozen=True)
class Shot:
    """Window in the state to show.

    Attributes:
        name: name of the picture.
        window: window to grab.
        wear: function that applies a palette to it, in addition to that of the application.
        over: dialog above its middle.
        settled: function that returns True when the window's animations have stopped.
    """

    name: str
    window: QWidget
    wear: Callable[[Palette], None] = nothing
    over: QWidget | None = None
    settled: Callable[[], bool] = lambda: True


@dataclass(frozen=True)
class Story:
    """States that follow from each other.

    Attributes:
        title: heading of these states.
        pictures: names of the pictures, in order, with a caption for each.
        shots: generator of the states in this order.
    """

    title: str
    pictures: Mapping[str, str]
    shots: Callable[[], Iterator[Shot]]
