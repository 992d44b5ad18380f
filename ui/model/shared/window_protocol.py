"""Messages between a host and its window, which runs in a separate process: one JSON object per line.

The window reads the host's messages from its standard input, and writes its own to its standard output.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import msgspec

FromHostT = TypeVar("FromHostT")
FromWindowT = TypeVar("FromWindowT")


@dataclass(frozen=True, slots=True)
class WindowProtocol(Generic[FromHostT, FromWindowT]):
    """Messages of one kind of window, and the rule for which of them a reopened window receives after a crash.

    Attributes:
        from_host: decoder of the host's messages.
        from_window: decoder of the window's messages.
        closed: the last message of a window that a person closed on purpose.
        kept: function that receives the messages kept so far and a new one; it returns the messages to keep for a
            reopened window.
    """

    from_host: msgspec.json.Decoder[FromHostT]
    from_window: msgspec.json.Decoder[FromWindowT]
    closed: FromWindowT
    kept: Callable[[Sequence[FromHostT], FromHostT], Sequence[FromHostT]]

    @staticmethod
    def encode(message: FromHostT | FromWindowT) -> bytes:
        """Return the line of a message."""
        return msgspec.json.encode(message) + b"\n"

    def decode_from_host(self, text: bytes) -> FromHostT:
        """Return the message in a line of the host.

        Raises:
            msgspec.DecodeError: the line is no message.
        """
        return self.from_host.decode(text)

    def decode_from_window(self, text: bytes) -> FromWindowT:
        """Return the message in a line of the window.

        Raises:
            msgspec.DecodeError: the line is no message.
        """
        return self.from_window.decode(text)
