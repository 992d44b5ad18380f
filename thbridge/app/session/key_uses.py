"""Uses of keys in a session, which are written to the log of the game."""

from collections.abc import Sequence

from thbridge.hunt.events import KeyUsed
from thbridge.text_protocol.wire.router import ClientJoined

_MOST_GRANTED = 200
"""Maximum number of requests with keys that are logged one by one before a tick. More can occur during a pause."""


class KeyUses:
    """Requests with keys that were granted since the last tick."""

    def __init__(self) -> None:
        self._granted: list[tuple[str, str]] = []

    @property
    def is_empty(self) -> bool:
        """True if no request was granted since the last tick."""
        return not self._granted

    def granted(self, key: str, request: str) -> None:
        """Record a granted request of a client with a key."""
        if len(self._granted) <= _MOST_GRANTED:
            more = len(self._granted) == _MOST_GRANTED
            self._granted.append((key, f"more than {_MOST_GRANTED} times before the next tick" if more else request))

    def take(self, game: str, joined: Sequence[ClientJoined]) -> list[KeyUsed]:
        """Return the entries for the log of a game.

        Args:
            game: name of the game, see `KeyUsed.run`. If empty, there is no game, and the requests so far are dropped.
            joined: programs that have joined with keys since the last tick.
        """
        granted, self._granted = self._granted, []
        if not game:
            return []
        return [
            *(KeyUsed(each.credentials.key, f"joined as {each.name}", game) for each in joined),
            *(KeyUsed(key, f"asked: {request}", game) for key, request in granted),
        ]
