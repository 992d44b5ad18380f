"""Sequence in a window: start page, practice game, and games until the participant leaves."""

import asyncio
from collections.abc import Awaitable, Callable
from enum import Enum
from typing import TypeAlias

from msgspec import structs

from thbridge.sockets.addresses import ListeningAddress
from thbridge.timing.wall_clock import utc_now
from ui.hosting.window_process import WindowProcess
from ui.model.lobby import (
    Agreed,
    Back,
    Begin,
    ChooseLanguage,
    Declined,
    FromHost,
    FromWindow,
    Join,
    Offer,
    Practise,
    Preparing,
    Thanks,
    WindowClosed,
)

WILDCARD_ADDRESSES = {"0.0.0.0": "127.0.0.1", "::": "::1"}
"""Wildcard addresses of a server, and the addresses at which a window reaches this server."""

LobbyWindow: TypeAlias = WindowProcess[FromHost, FromWindow]
"""Process of the participant's window."""


class GameVisit:
    """Visit of a participant to one game, from joining the game to leaving it.

    Args:
        window: window of the participant.
        token: secret by which the server recognizes the window.
        practice: True for the practice game.
        agreed_at: time of day at which the participant agreed to take part; empty if the study asks no such question.
        seat: name of the participant's seat; empty in a game with one participant.
    """

    def __init__(self, window: LobbyWindow, token: str, practice: bool, agreed_at: str, seat: str = "") -> None:
        self._window = window
        self._token = token
        self._practice = practice
        self._agreed_at = agreed_at
        self._seat = seat
        self._joining: asyncio.Task[None] | None = None
        self.ended: Back | WindowClosed | None = None
        """Message with which the participant left; None while they are in the game."""

    def ready(self, where: ListeningAddress) -> None:
        """Make the window join the game at this address."""
        host = WILDCARD_ADDRESSES.get(where.host, where.host)
        join = Join(host, where.port, self._token, self._practice, self._agreed_at, self._seat)
        self._joining = asyncio.get_running_loop().create_task(self._window.send(join))

    def has_left(self) -> bool:
        """Return True if the participant has left; called between two ticks."""
        request = self._window.pending_request()
        if isinstance(request, Back | WindowClosed):
            self.ended = request
        return self.ended is not None


class Answer(Enum):
    """Answer to the question whether the participant takes part; YES if there was no question."""

    YES = "yes"
    NO = "no"
    NONE = "none"


PlayGame = Callable[[GameVisit], Awaitable[None]]
"""Function that plays a game until the participant has left."""


async def host(
    window: LobbyWindow,
    offer: Offer,
    token: str,
    play: Callable[[int], PlayGame],
    practise: Callable[[], PlayGame],
    speak: Callable[[Offer, str], Offer] | None = None,
    seat: str = "",
) -> Answer:
    """Play games until the participant closes the window. No game starts before the participant agrees to take part.

    Args:
        window: window of the participant; it is opened here.
        offer: numbers of robots to choose from, text to agree to, and texts of the study's language.
        token: secret by which the server recognizes the window.
        play: function that returns a game with a given number of robots.
        practise: function that returns the practice game.
        speak: function that returns an offer in another language, and plays later games in this language.
        seat: name of the participant's seat; empty in a game with one participant.

    Returns:
        The participant's answer. The answer no is final, even if the window later sends other messages.
    """
    agreed_at = ""
    async with window.opened():
        await window.send(offer)
        while True:
            request = await window.next_request()
            match request:
                case WindowClosed():
                    return Answer.NONE if offer.consent else Answer.YES
                case Declined() if offer.consent:
                    await window.send(Thanks(offer.texts))
                    while not isinstance(await window.next_request(), WindowClosed):
                        pass
                    return Answer.NO
                case Agreed() if offer.consent:
                    offer, agreed_at = structs.replace(offer, consent=""), utc_now()
                    await window.send(offer)
                    continue
                case _ if offer.consent:
                    continue
                case ChooseLanguage(language) if speak is not None and language in offer.languages:
                    offer = speak(offer, language)
                    await window.send(offer)
                    continue
                case Begin(robots) if offer.least <= robots <= offer.most:
                    await window.send(Preparing(offer.texts.text("pages.preparing", count=robots)))
                    visit, game = GameVisit(window, token, False, agreed_at, seat), play(robots)
                case Practise():
                    await window.send(Preparing(offer.texts.text("pages.preparing_practice")))
                    visit, game = GameVisit(window, token, practice=True, agreed_at=""), practise()
                case _:
                    continue
            await game(visit)
            if isinstance(visit.ended, WindowClosed):
                return Answer.YES
            await window.send(offer)
