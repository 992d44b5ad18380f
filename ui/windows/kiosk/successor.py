"""A window whose host has died stays until another one opens in its place, so that nobody sees the desktop."""

import getpass
from collections.abc import Callable

from PySide6.QtCore import QObject
from PySide6.QtNetwork import QLocalServer, QLocalSocket

_PATIENCE = 200
"""Milliseconds for which another window is asked to go."""


class Successor(QObject):
    """Tells the window of an earlier program that this one is there, and hears of a later one.

    Args:
        comes: called when a later window has opened.
    """

    def __init__(self, comes: Callable[[], None]) -> None:
        super().__init__()
        name = f"thbridge-kiosk-{getpass.getuser()}"
        asked = QLocalSocket(self)
        asked.connectToServer(name)
        asked.waitForConnected(_PATIENCE)
        asked.disconnectFromServer()
        self._server = QLocalServer(self)
        self._server.newConnection.connect(comes)
        QLocalServer.removeServer(name)
        self._server.listen(name)
