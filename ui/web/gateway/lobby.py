"""Lobby: people wait there until the seats of a game are filled."""

import asyncio
import time
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from enum import Enum

from ui.web.gateway.browser_window import BrowserWindow
from ui.web.gateway.matching import MatchingRule, WaitingPerson

OUT = 10.0
"""Seconds without a browser after which a person is not in the lobby any more. When they come back, they wait behind
all others."""
LOOK = 0.2
"""Seconds between two looks if the browser of a person is back."""


class WaitEnd(Enum):
    """End of a person's wait in a lobby."""

    PLACED = "placed"
    """The person's game starts."""
    STOPPED = "stopped"
    """The person does not want to wait."""
    TOO_LONG = "too long"
    """The person has waited so long that they need not wait any longer."""
    CLOSED = "closed"
    """No further games start on this server."""


@dataclass(frozen=True, slots=True)
class GamePlace:
    """Place of a person in a game of several.

    Attributes:
        game: key of the game.
        seat: name of their seat.
        people: all people of the game, by their seats.
    """

    game: str
    seat: str
    people: Mapping[str, str]


class Lobby:
    """People who wait for a game of several. They take places only when a game starts.

    A person who leaves, or whose browser is not connected at the moment, is not matched, and blocks nobody.

    Args:
        rule: rule of which people play together.
        begin: function that receives the people of a game that starts, by their seats, and returns its key.
        has_room: function that returns True if another game can start now.
        clock: monotonic clock, seconds.
    """

    def __init__(
        self,
        rule: MatchingRule,
        begin: Callable[[Mapping[str, str]], str],
        has_room: Callable[[], bool],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._rule = rule
        self._begin = begin
        self._has_room = has_room
        self._clock = clock
        self._waiting: dict[str, tuple[WaitingPerson, Callable[[], bool]]] = {}
        self._places: dict[str, GamePlace] = {}

    def enter(self, person: str, is_here: Callable[[], bool]) -> None:
        """Let a person wait behind all others; `is_here` returns True while their browser is connected."""
        self._waiting[person] = WaitingPerson(person, self._clock()), is_here

    def leave(self, person: str) -> None:
        """Stop waiting; this has no effect on a person whose game has started."""
        self._waiting.pop(person, None)

    def place(self, person: str) -> GamePlace | None:
        """Return the place of a person whose game has started, after all games that can start now have started."""
        while self._has_room() and self._start():
            pass
        return self._places.get(person)

    def take_place(self, person: str) -> GamePlace | None:
        """Return the place of a person as `place` does, and forget it."""
        self.place(person)
        return self._places.pop(person, None)

    def waits_too_long(self, person: str) -> bool:
        """Return True if a person need not wait any longer."""
        return person in self._waiting and self._rule.ends_wait(self._waiting[person][0], self._clock())

    @property
    def seconds(self) -> Mapping[str, float]:
        """Seconds for which each person has waited, in the order of their arrival."""
        now = self._clock()
        return {person: now - each.since for person, (each, _) in self._waiting.items()}

    def _start(self) -> bool:
        """Start a game if the rule finds one."""
        here = [each for each, is_here in self._waiting.values() if is_here()]
        people = self._rule.next_game(here, self._clock())
        if people is None:
            return False
        game = self._begin(people)
        for seat, person in people.items():
            del self._waiting[person]
            self._places[person] = GamePlace(game, seat, people)
        return True


async def await_place(
    lobby: Lobby,
    person: str,
    window: BrowserWindow,
    show: Callable[[Callable[[], bool]], Awaitable[bool]],
    is_closed: Callable[[], bool],
) -> tuple[WaitEnd, GamePlace | None]:
    """Let a person wait in a lobby; return the end of the wait, and the person's place if their game starts.

    Args:
        lobby: the lobby.
        person: key of the person.
        window: browser of the person.
        show: function that shows the waiting page until its argument returns True; it returns False if the person stops
            waiting.
        is_closed: function that returns True after no further games start.
    """

    def is_over() -> bool:
        has_place = lobby.place(person) is not None
        return has_place or is_closed() or window.absence > OUT or lobby.waits_too_long(person)

    while True:
        while window.absence > 0.0 and not is_closed():
            await asyncio.sleep(LOOK)
        lobby.enter(person, lambda: window.absence == 0.0)
        try:
            waits = await show(is_over)
            if (place := lobby.take_place(person)) is not None:
                return WaitEnd.PLACED, place
            if is_closed():
                return WaitEnd.CLOSED, None
            if not waits:
                return WaitEnd.STOPPED, None
            if lobby.waits_too_long(person):
                return WaitEnd.TOO_LONG, None
        finally:
            lobby.leave(person)
