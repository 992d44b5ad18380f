"""Windows to be pictured, and the stories that bring them into their states."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from tempfile import mkdtemp

from PySide6.QtCore import QSettings
from PySide6.QtWidgets import QApplication, QWidget

from ui.model.shared.theme import Palette
from ui.windows.preferences import Preferences


def unkept_preferences() -> Preferences:
    """Return preferences for pictures, in a file that nobody reads again."""
    application = QApplication.instance()
    if not isinstance(application, QApplication):
        raise TypeError("windows need an application")
    file = Path(mkdtemp()) / "settings.ini"
    return Preferences(application, QSettings(str(file), QSettings.Format.IniFormat), "light")


def nothing(_palette: Palette) -> None:
    """Do nothing: for windows that follow the application's colors by themselves."""


@dataclass(frozen=True)
class Shot:
    """A window in the state to be shown.

    Attributes:
        name: of the picture.
        window: to be grabbed.
        wear: applies a palette to it, besides that of the application.
        over: a dialogue box above its middle.
        settled: returns True when the window's own animations have come to rest.
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
        pictures: their names, in order, and a caption for each.
        tell: yields them in this order.
    """

    title: str
    pictures: Mapping[str, str]
    tell: Callable[[], Iterator[Shot]]
