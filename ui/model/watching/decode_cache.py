"""Cache of decoded messages, so that each message is decoded only once."""

from collections.abc import Callable
from typing import Generic, TypeVar

from ui.model.watching.messages import WatchedMessage

T = TypeVar("T")


class DecodeCache(Generic[T]):
    """Decoded values of the last message of each topic; each message is decoded only once.

    Args:
        unpack: function that decodes the bytes of a message. It raises ValueError if the bytes are malformed.
    """

    def __init__(self, unpack: Callable[[bytes], T]) -> None:
        self._unpack = unpack
        self._known: dict[str, tuple[bytes, T | None]] = {}

    def of(self, message: WatchedMessage | None) -> T | None:
        """Return the decoded value of a message; None if there is no message or the message is unreadable."""
        if message is None:
            return None
        known = self._known.get(message.topic)
        if known is None or known[0] is not message.data:
            try:
                known = (message.data, self._unpack(message.data))
            except ValueError:
                known = (message.data, None)
            self._known[message.topic] = known
        return known[1]
