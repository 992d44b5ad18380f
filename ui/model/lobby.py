"""Messages between the program that runs the games (host) and the participant's window, before and after a game.

The window is a process of its own, so that nothing of a game can be in it that the game has not told.
"""

from collections.abc import Mapping, Sequence
from typing import TypeAlias

import msgspec

from thbridge.dialogue.wording.texts import Texts
from ui.model.shared.window_protocol import WindowProtocol


class Offer(msgspec.Struct, frozen=True, tag=True):
    """Host: show the start page.

    Attributes:
        texts: of the study's language, for all pages from now on.
        least: smallest number of robots that may be chosen.
        most: largest number.
        usual: number in the study.
        rules: of the game, in sentences.
        consent: text to agree to before anything else; empty: nothing, or no more.
        languages: languages that the participant may choose from, by their names; empty: the study has chosen.
    """

    texts: Texts
    least: int
    most: int
    usual: int
    rules: tuple[str, ...] = ()
    consent: str = ""
    languages: Mapping[str, str] = {}


class Preparing(msgspec.Struct, frozen=True, tag=True):
    """Host: the requested game is being prepared; `sentence` tells people so."""

    sentence: str


class Join(msgspec.Struct, frozen=True, tag=True):
    """Host: the game waits at this address.

    Attributes:
        host: host of its text server.
        port: port of its text server.
        token: secret by which the server recognizes this participant.
        practice: True for the practice game.
        agreed_at: time of day at which the participant agreed to take part; empty: nothing was asked.
    """

    host: str
    port: int
    token: str
    practice: bool
    agreed_at: str = ""


class Thanks(msgspec.Struct, frozen=True, tag=True):
    """Host: thank the participant, who does not take part; nothing more is asked of them.

    Attributes:
        texts: of the study's language.
    """

    texts: Texts


class Agreed(msgspec.Struct, frozen=True, tag=True):
    """Window: the participant agrees to take part."""


class Declined(msgspec.Struct, frozen=True, tag=True):
    """Window: the participant does not take part."""


class Begin(msgspec.Struct, frozen=True, tag=True):
    """Window: play with so many robots."""

    robots: int


class Practise(msgspec.Struct, frozen=True, tag=True):
    """Window: play the practice game."""


class ChooseLanguage(msgspec.Struct, frozen=True, tag=True):
    """Window: play in this language."""

    language: str


class Back(msgspec.Struct, frozen=True, tag=True):
    """Window: leave this game and show the start page."""


class WindowClosed(msgspec.Struct, frozen=True, tag="Leave"):
    """Window: the participant closed it on purpose."""


FromHost: TypeAlias = Offer | Preparing | Join | Thanks
FromWindow: TypeAlias = Agreed | Declined | Begin | Practise | ChooseLanguage | Back | WindowClosed


def _kept(before: Sequence[FromHost], message: FromHost) -> Sequence[FromHost]:
    """A page that begins anew takes the place of all before it."""
    return [message] if isinstance(message, Offer | Thanks) else [*before, message]


LOBBY = WindowProtocol(msgspec.json.Decoder(FromHost), msgspec.json.Decoder(FromWindow), WindowClosed(), _kept)
"""Messages of the participant's window."""
