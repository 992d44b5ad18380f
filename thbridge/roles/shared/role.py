"""The interface of a role to the session or program that runs it."""

from collections.abc import Sequence
from typing import Protocol

from thbridge.text_protocol.wire.lines import TextMessage


class Role(Protocol):
    """One program of the game without its socket."""

    @property
    def name(self) -> str:
        """The name it holds at the server."""

    def connected(self) -> None:
        """Note that the server has (again) accepted the name: the role introduces itself with the next step."""

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Take the messages to this role since the last tick, and return those that it sends."""
