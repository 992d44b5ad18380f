"""Windows to picture, and sequences of their states."""

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
    """Do nothing; for windows that follow the application's palette."""


@dataclass(frozen=True)
class Shot:
    """Window in the state to show.

    Attributes:
        name: name of the picture.
        window: window to grab.
        wear: function that applies a palette to the window, in addition to the application's palette.
        over: dialog that is drawn over the middle of the window.
        settled: function that returns True when the window's animations have stopped.
    """

    name: str
    window: QWidget
    wear: Callable[[Palette], None] = nothing
    over: QWidget | None = None
    settled: Callable[[], bool] = lambda: True


@dataclass(frozen=True)
class Story:
    """Sequence of states; each state follows from the previous one.

    Attributes:
        title: heading of these states.
        pictures: names of the pictures, in order, with a caption for each.
        shots: function that yields the states in this order.
    """

    title: str
    pictures: Mapping[str, str]
    shots: Callable[[], Iterator[Shot]]
