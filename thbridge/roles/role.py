"""What every role is to the session or program that runs it."""

from collections.abc import Sequence
from typing import Protocol

from thbridge.wire.text import TextMessage


class Role(Protocol):
    """One program of the game without its socket."""

    @property
    def name(self) -> str:
        """The name it holds at the server."""

    def connected(self) -> None:
        """The server has (again) accepted the name: introduce yourself with the next step."""

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Take in what was said to this role since the last tick and say what there is to say."""
