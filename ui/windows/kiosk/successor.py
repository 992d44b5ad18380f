"""Replacement of a kiosk window whose host has died.

The old window stays open until the new window replaces it, so that people never see the desktop.
"""

import getpass
from collections.abc import Callable

from PySide6.QtCore import QObject
from PySide6.QtNetwork import QLocalServer, QLocalSocket

_TIMEOUT = 200
"""Milliseconds to wait for the connection to an earlier window."""


class Successor(QObject):
    """Connection between successive windows.

    It informs an earlier window that this window is open, and then waits for a later window.

    Args:
        comes: function to call when a later window has opened.
    """

    def __init__(self, comes: Callable[[], None]) -> None:
        super().__init__()
        name = f"thbridge-kiosk-{getpass.getuser()}"
        asked = QLocalSocket(self)
        asked.connectToServer(name)
        asked.waitForConnected(_TIMEOUT)
        asked.disconnectFromServer()
        self._server = QLocalServer(self)
        self._server.newConnection.connect(comes)
        QLocalServer.removeServer(name)
        self._server.listen(name)
