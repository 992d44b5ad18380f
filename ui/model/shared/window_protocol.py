"""Messages between a host and its window, which runs in a separate process: one JSON object per line.

The window reads messages from its standard input, and writes messages to its standard output.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import msgspec

FromHostT = TypeVar("FromHostT")
FromWindowT = TypeVar("FromWindowT")


@dataclass(frozen=True, slots=True)
class WindowProtocol(Generic[FromHostT, FromWindowT]):
    """Messages of one kind of window, and the choice of messages that are sent again to a window after a crash.

    Attributes:
        from_host: decoder of the host's messages.
        from_window: decoder of the window's messages.
        closed: last message of a window that a person closed on purpose.
        kept: function that returns the messages to send again to a reopened window. Its arguments are the previous
            result and a new message.
    """

    from_host: msgspec.json.Decoder[FromHostT]
    from_window: msgspec.json.Decoder[FromWindowT]
    closed: FromWindowT
    kept: Callable[[Sequence[FromHostT], FromHostT], Sequence[FromHostT]]

    @staticmethod
    def encode(message: FromHostT | FromWindowT) -> bytes:
        """Return a message as a line."""
        return msgspec.json.encode(message) + b"\n"

    def decode_from_host(self, text: bytes) -> FromHostT:
        """Return the message in a line from the host.

        Raises:
            msgspec.DecodeError: the line is not a valid message.
        """
        return self.from_host.decode(text)

    def decode_from_window(self, text: bytes) -> FromWindowT:
        """Return the message in a line from the window.

        Raises:
            msgspec.DecodeError: the line is not a valid message.
        """
        return self.from_window.decode(text)
