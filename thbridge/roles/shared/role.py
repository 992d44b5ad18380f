"""Interface of a role for the session or program that runs the role."""

from collections.abc import Sequence
from typing import Protocol

from thbridge.text_protocol.wire.lines import TextMessage


class Role(Protocol):
    """A program of the game without its socket."""

    @property
    def name(self) -> str:
        """Name of the role at the server."""

    def connected(self) -> None:
        """Process a connection: the server has accepted the name. The role sends its first notices in the next step."""

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Process the messages to this role since the last tick. Return the messages from this role."""
