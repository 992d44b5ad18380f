"""Messages between the program that runs the games (host) and the participant's window, before and after a game.

The window runs in a separate process, so it knows only the data that the game has sent. The docstring of each message
begins with the sender of the message.
"""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import msgspec

from thbridge.dialogue.wording.texts import Texts
from ui.model.shared.window_protocol import WindowProtocol


class Offer(msgspec.Struct, frozen=True, tag=True):
    """Host: show the start page.

    Attributes:
        texts: texts of the study's language, for this page and all following pages.
        least: smallest number of robots that the participant may choose.
        most: maximum number of robots that the participant may choose.
        usual: number of robots in the study.
        rules: rules of the game, in sentences.
        consent: text to which the participant must consent first; empty if the study has none, or consent was given.
        languages: names of the languages from which the participant may choose; empty if the study sets the language.
    """

    texts: Texts
    least: int
    most: int
    usual: int
    rules: tuple[str, ...] = ()
    consent: str = ""
    languages: Mapping[str, str] = {}


class Preparing(msgspec.Struct, frozen=True, tag=True):
    """Host: the requested game is being prepared; the window shows `sentence` to the participant."""

    sentence: str


class Join(msgspec.Struct, frozen=True, tag=True):
    """Host: join a game at a text server.

    Attributes:
        host: host of the game's text server.
        port: port of the game's text server.
        token: secret by which the server recognizes this participant.
        practice: True for the practice game.
        agreed_at: date and time at which the participant gave consent; empty if the study did not ask for consent.
        seat: name of the participant's seat; empty in a game with one participant.
    """

    host: str
    port: int
    token: str
    practice: bool
    agreed_at: str = ""
    seat: str = ""


class Thanks(msgspec.Struct, frozen=True, tag=True):
    """Host: thank a participant who does not take part.

    Attributes:
        texts: texts of the study's language.
    """

    texts: Texts


class Agreed(msgspec.Struct, frozen=True, tag=True):
    """Window: the participant gives consent."""


class Declined(msgspec.Struct, frozen=True, tag=True):
    """Window: the participant declines."""


class Begin(msgspec.Struct, frozen=True, tag=True):
    """Window: start a game with this number of robots."""

    robots: int


class Practise(msgspec.Struct, frozen=True, tag=True):
    """Window: play the practice game."""


class ChooseLanguage(msgspec.Struct, frozen=True, tag=True):
    """Window: play in this language."""

    language: str


class Back(msgspec.Struct, frozen=True, tag=True):
    """Window: the participant leaves this game; show the start page."""


class WindowClosed(msgspec.Struct, frozen=True, tag="Leave"):
    """Window: the participant closed the window on purpose."""


FromHost: TypeAlias = Offer | Preparing | Join | Thanks
FromWindow: TypeAlias = Agreed | Declined | Begin | Practise | ChooseLanguage | Back | WindowClosed


def _kept(before: Sequence[FromHost], message: FromHost) -> Sequence[FromHost]:
    """Return the messages that a reopened window needs: the last page and all later messages."""
    return [message] if isinstance(message, Offer | Thanks) else [*before, message]


LOBBY = WindowProtocol(msgspec.json.Decoder(FromHost), msgspec.json.Decoder(FromWindow), WindowClosed(), _kept)
"""Messages between host and the participant's window."""
