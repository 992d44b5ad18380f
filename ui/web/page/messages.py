"""Messages of a browser about the page of a game; messages about pages of a study are those of `ui.model.kiosk`.

Each message has the number of the page that the person saw and the time `at` in the browser's own monotonic
milliseconds. The server compares these times only with each other.
"""

from typing import TypeAlias

import msgspec

from ui.model.playing import screen
from ui.model.playing.keys import OVER
from ui.model.playing.screen import Act, GoOnFromGame


class PagePainted(msgspec.Struct, frozen=True, tag_field="t", tag="painted"):
    """Browser: this page is on the screen."""

    n: int
    at: float


class ActDone(msgspec.Struct, frozen=True, tag_field="t", tag="act"):
    """Browser: the person pressed a button, a room or a robot.

    Attributes:
        n: number of the page.
        at: time.
        act: the act of the button, as the page had it.
        on_map: True if the person pressed on the map.
    """

    n: int
    at: float
    act: "dict[str, str | int | bool | None]"
    on_map: bool = False


class KeyPressed(msgspec.Struct, frozen=True, tag_field="t", tag="key"):
    """Browser: the person pressed a key; `key` is its name as in `ui.model.playing.keys`."""

    n: int
    at: float
    key: str


FromGamePage: TypeAlias = PagePainted | ActDone | KeyPressed

FROM_GAME_PAGE = msgspec.json.Decoder(FromGamePage)

_ACTS: dict[str, type[Act]] = {
    kind.__name__: kind for kind in vars(screen).values() if isinstance(kind, type) and issubclass(kind, Act)
}


def decode_act(given: "dict[str, str | int | bool | None]") -> Act | None:
    """Return the act in a message; None if it is malformed."""
    fields = dict(given)
    kind = _ACTS.get(str(fields.pop("act", "")))
    if kind is None:
        return None
    try:
        return msgspec.convert(fields, kind, strict=True)
    except msgspec.ValidationError:
        return None


def leads_on(message: FromGamePage) -> bool:
    """Return True if a message leads from the page of an ended game to the next part of the study."""
    match message:
        case ActDone(act=given):
            return decode_act(given) == GoOnFromGame()
        case KeyPressed(key=key):
            return any(key in binding.keys for binding in OVER if binding.act == GoOnFromGame())
        case _:
            return False
