"""Connection to a game in a thread next to the participant's window.

In each frame, the window takes the events received so far and replaces its open requests. The threads share no other
data.
"""

import asyncio
import threading
from collections import deque

from thbridge.files.keys.key_file import ClientKey
from thbridge.hunt.seats import PlayedBy
from thbridge.roles.shared.view import GiveConsent, ParticipantRequest
from ui.sources.game import GameConnection, ReceivedEvent


class ParticipantLink:
    """Link that keeps a participant's window connected to a server until the link is stopped.

    The arguments are those of `GameConnection`.
    """

    def __init__(
        self,
        host: str,
        port: int,
        token: str,
        consent: GiveConsent | None = None,
        key: ClientKey | None = None,
        seat: str = "",
        by: PlayedBy = PlayedBy.PERSON,
    ) -> None:
        # No lock is needed: appending to a deque, taking from it, and replacing a tuple are single steps of the
        # interpreter.
        self._events: deque[ReceivedEvent] = deque()
        self._connection = GameConnection(host, port, token, self._events.append, consent, key, seat, by)
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="link", daemon=True)

    def start(self) -> None:
        """Start connecting."""
        self._thread.start()

    def stop(self) -> None:
        """Disconnect from the server, and return when the thread has ended."""
        self._stopped.set()
        self._thread.join()

    def take_events(self) -> list[ReceivedEvent]:
        """Return the events since the last call, oldest first."""
        return [self._events.popleft() for _ in range(len(self._events))]

    def request(self, requests: tuple[ParticipantRequest, ...]) -> None:
        """Set all open requests; each is sent again until it is granted."""
        self._connection.requested = requests

    def decline(self) -> None:
        """Report to the server that the participant declines to take part.

        The link sends this message even if `stop` is called at once.
        """
        self._connection.declined = True

    def _run(self) -> None:
        asyncio.run(self._connection.run(self._stopped.is_set))
