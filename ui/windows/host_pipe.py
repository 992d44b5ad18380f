"""Connection of a window to its host by standard input and output. The host is the program that opened the window."""

import sys
import threading
from collections import deque
from typing import Generic, Protocol, TypeVar

import msgspec
from PySide6.QtCore import QEvent, QObject

from ui.model.shared.window_protocol import FromHostT, FromWindowT, WindowProtocol

PERIOD = 15
"""Milliseconds between two checks for received messages."""

Message_contra = TypeVar("Message_contra", contravariant=True)


class HostedWindow(Protocol[Message_contra]):
    """Interface of a window that a host opens."""

    def receive(self, message: Message_contra) -> None:
        """Act on a message from the host."""

    def leave(self) -> None:
        """Close the window without a question, because the host has ended or requests this."""


class HostPipe(QObject, Generic[FromHostT, FromWindowT]):
    """Pipes to and from the host.

    Args:
        protocol: protocol of the messages between host and window.
    """

    def __init__(self, protocol: WindowProtocol[FromHostT, FromWindowT]) -> None:
        super().__init__()
        self._protocol = protocol
        self._window: HostedWindow[FromHostT] | None = None
        # The reading thread appends messages, and the window's thread removes them. Each of the two operations is a
        # single step of the interpreter, so no lock is needed.
        self._received: deque[FromHostT | None] = deque()

    def listen(self, window: HostedWindow[FromHostT]) -> None:
        """Pass the host's messages on to a window from now on."""
        self._window = window
        threading.Thread(target=self._listen, name="host", daemon=True).start()
        self.startTimer(PERIOD)

    def send(self, message: FromWindowT) -> None:
        """Send a message to the host. If the host has ended, drop the message."""
        try:
            sys.stdout.buffer.write(self._protocol.encode(message))
            sys.stdout.buffer.flush()
        except OSError:
            pass

    def timerEvent(self, _event: QEvent) -> None:
        """Pass received messages on to the window."""
        while self._received and self._window is not None:
            message = self._received.popleft()
            if message is None:
                self._window.leave()
            else:
                self._window.receive(message)

    def _listen(self) -> None:
        for text in sys.stdin.buffer:
            try:
                self._received.append(self._protocol.decode_from_host(text))
            except msgspec.DecodeError:
                continue
        self._received.append(None)
