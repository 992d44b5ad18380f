"""What a state hands over to have its picture taken."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

from PySide6.QtWidgets import QWidget

from ui.model.theme import Palette


def nothing(_palette: Palette) -> None:
    """For windows that follow the application's colours by themselves."""


@dataclass(frozen=True)
class Shot:
    """A window in the state to be shown.

    Attributes:
        name: of the picture.
        window: to be grabbed.
        wear: puts other colours on it, besides those of the application.
        over: a dialogue that stands above its middle.
        settled: whether what the window draws by itself, such as moving figures, has come to rest.
    """

    name: str
    window: QWidget
    wear: Callable[[Palette], None] = nothing
    over: QWidget | None = None
    settled: Callable[[], bool] = lambda: True


@dataclass(frozen=True)
class Story:
    """States that come one out of the other.

    Attributes:
        title: what these states are of.
        pictures: their names, in order, and what each shows.
        tell: gives them in this order.
    """

    title: str
    pictures: Mapping[str, str]
    tell: Callable[[], Iterator[Shot]]
