"""Uses of keys in a session, for the log of the game."""

from collections.abc import Sequence

from thbridge.hunt.events import KeyUsed
from thbridge.text_protocol.wire.router import ClientJoined

_MOST_GRANTED = 200
"""Requests by keys before a tick that are logged one by one: in a pause there may be many about its pace."""


class KeyUses:
    """Requests that were granted by keys since the last tick."""

    def __init__(self) -> None:
        self._granted: list[tuple[str, str]] = []

    def granted(self, key: str, request: str) -> None:
        """Note that the holder of a key was granted a request."""
        if len(self._granted) <= _MOST_GRANTED:
            more = len(self._granted) == _MOST_GRANTED
            self._granted.append((key, f"more than {_MOST_GRANTED} times before the next tick" if more else request))

    def take(self, game: str, joined: Sequence[ClientJoined]) -> list[KeyUsed]:
        """Return the entries for the log of a game; see `KeyUsed.run` for its name.

        Args:
            game: its name; empty: there is none, and what was granted before is forgotten.
            joined: programs that take part by keys since the last tick.
        """
        granted, self._granted = self._granted, []
        if not game:
            return []
        return [
            *(KeyUsed(each.credentials.key, f"joined as {each.name}", game) for each in joined),
            *(KeyUsed(key, f"asked: {request}", game) for key, request in granted),
        ]
