"""Lobby: people at browsers wait there until the seats of a game are filled."""

import time
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum

from ui.web.gateway.matching import MatchedGame, Matching


class WaitEnd(Enum):
    """End of a person's wait in a lobby."""

    PLACED = "placed"
    """The person's game starts."""
    STOPPED = "stopped"
    """The person does not want to wait."""
    UNMATCHED = "unmatched"
    """The rule has ended the wait: too few people have come."""
    CLOSED = "closed"
    """No further games start on this server."""


@dataclass(slots=True)
class _Waiting:
    """Person who waits; `since` is the time since which they are in the lobby, or None if they are not."""

    is_here: Callable[[], bool]
    since: float | None = None
    game: MatchedGame | None = field(default=None)
    has_ended: bool = False


class ServedLobby:
    """People who wait for a game of several. They take places only when a game starts.

    A person whose browser is not connected is not in the lobby and does not block the others. When they come back,
    they wait behind all others.

    Args:
        matching: rule of who plays together.
        begin: function that receives each game that starts.
        room: function that returns the number of games that can start now.
        clock: monotonic clock, seconds.
    """

    def __init__(
        self,
        matching: Matching,
        begin: Callable[[MatchedGame], None],
        room: Callable[[], int],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._matching = matching
        self._begin = begin
        self._room = room
        self._clock = clock
        self._people: dict[str, _Waiting] = {}

    def enter(self, person: str, is_here: Callable[[], bool]) -> None:
        """Let a person wait; `is_here` returns True while their browser is connected."""
        self._people[person] = _Waiting(is_here)

    def leave(self, person: str) -> None:
        """Stop waiting."""
        self._people.pop(person, None)
        self._matching.leave(person)

    def look(self, person: str) -> tuple[MatchedGame | None, bool]:
        """Return the game of a person who has entered, if it has started, and True if their wait has ended without one.

        All games start that can start now.
        """
        self._update()
        waiting = self._people[person]
        return waiting.game, waiting.has_ended

    @property
    def seconds(self) -> Mapping[str, float]:
        """Seconds for which each person in the lobby has waited."""
        now = self._clock()
        return {person: now - each.since for person, each in self._people.items() if each.since is not None}

    def _update(self) -> None:
        now = self._clock()
        for person, each in self._people.items():
            waits = each.game is None and not each.has_ended and each.is_here()
            if waits and each.since is None:
                self._matching.enter(person, now)
            elif not waits and each.since is not None:
                self._matching.leave(person)
            each.since = None if not waits else now if each.since is None else each.since
        matches = self._matching.update(now, self._room())
        for game in matches.games:
            for person in game.people.values():
                self._people[person].game, self._people[person].since = game, None
            self._begin(game)
        for person in matches.ended:
            self._people[person].has_ended, self._people[person].since = True, None


async def await_place(
    lobby: ServedLobby,
    person: str,
    is_here: Callable[[], bool],
    show: Callable[[Callable[[], bool]], Awaitable[bool]],
    is_closed: Callable[[], bool],
) -> tuple[WaitEnd, MatchedGame | None]:
    """Let a person wait in a lobby; return the end of the wait, and their game if it starts.

    Args:
        lobby: the lobby.
        person: key of the person.
        is_here: function that returns True while the person's browser is connected.
        show: function that shows the waiting page until its argument returns True; it returns False if the person stops
            waiting.
        is_closed: function that returns True after no further games start.
    """
    lobby.enter(person, is_here)
    try:
        waits = await show(lambda: is_closed() or lobby.look(person) != (None, False))
        game, has_ended = lobby.look(person)
    finally:
        lobby.leave(person)
    if game is not None:
        return WaitEnd.PLACED, game
    if has_ended:
        return WaitEnd.UNMATCHED, None
    return WaitEnd.STOPPED if not waits else WaitEnd.CLOSED, None
