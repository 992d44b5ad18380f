"""Interface of a role to the session or program that runs it."""

from collections.abc import Sequence
from typing import Protocol

from thbridge.text_protocol.wire.lines import TextMessage


class Role(Protocol):
    """One program of the game without its socket."""

    @property
    def name(self) -> str:
        """Name of the role at the server."""

    def connected(self) -> None:
        """Note that the server has (again) accepted the name: the role introduces itself in the next step."""

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Process the messages to this role since the last tick, and return its own messages."""
