"""Messages between a host and its window in a process of its own: one JSON object a line.

The host's come at the window's standard input, the window's at its standard output.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import msgspec

FromHostT = TypeVar("FromHostT")
FromWindowT = TypeVar("FromWindowT")


@dataclass(frozen=True, slots=True)
class WindowProtocol(Generic[FromHostT, FromWindowT]):
    """The messages of one kind of window, and which of them a window gets that is opened again after a crash.

    Attributes:
        from_host: decoder of the host's messages.
        from_window: decoder of the window's.
        closed: the last message of a window that is closed on purpose.
        kept: from the messages kept so far and a new one, those to keep: a window that is opened again gets them.
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
            msgspec.DecodeError: it is none.
        """
        return self.from_host.decode(text)

    def decode_from_window(self, text: bytes) -> FromWindowT:
        """Return the message in a line of the window.

        Raises:
            msgspec.DecodeError: it is none.
        """
        return self.from_window.decode(text)
