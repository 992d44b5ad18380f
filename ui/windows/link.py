"""Participant's program. It communicates with the server in its own thread, separate from the window's thread.

In each frame, the window takes the events received so far and replaces its open requests. The threads share no other
data.
"""

import asyncio
import secrets
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from sim.common.observations import TICK
from thbridge.app.programs import exchange
from thbridge.files.keys.key_file import ClientKey
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared.view import GiveConsent, ParticipantRequest, View
from thbridge.sockets.reconnecting import Backoff, ConnectionLost
from thbridge.text_protocol.sockets.client import TextClient
from thbridge.text_protocol.wire.lines import TextMessage

POLL_PERIOD = 0.005
"""Seconds between two polls of the connection.

On average, polling delays the drawing of robots by half of this time, plus the jitter that polling adds to pose
telemetry.
"""

RECONNECT_BACKOFF = Backoff(initial=0.25, maximum=2.0)
"""Delays between attempts to reconnect.

They are short, because a person waits. The link connects within two seconds after the server is available again.
"""


@dataclass(frozen=True, slots=True)
class ServerReached:
    """Event: the connection to the server is established, for the first time or again."""


ServerEvent: TypeAlias = ParticipantUpdate | ServerReached | ConnectionLost


@dataclass(frozen=True, slots=True)
class ReceivedEvent:
    """Event with the monotonic time of its arrival, seconds; the window may handle the event later."""

    time: float
    event: ServerEvent


_FIRST_NUMBERS = 1 << 31
"""Upper limit of the randomly chosen number of a window's first request."""


class ParticipantLink:
    """Link that keeps a participant's program connected to a server until the link is stopped.

    Args:
        host: host of the server.
        port: port of the server.
        token: id of this run of the program. The server recognizes a program that reconnects by this id.
        consent: consent of a participant who has already agreed. If None, the participant has not agreed or was not
            asked.
        key: key to present to the server. If None, no key is presented.

    Raises:
        ValueError: the token is not a single word.
    """

    def __init__(
        self,
        host: str,
        port: int,
        token: str,
        consent: GiveConsent | None = None,
        key: ClientKey | None = None,
    ) -> None:
        self._client = TextClient(TabUI.name, token, host, port, RECONNECT_BACKOFF, key)
        self._token = token
        self._consent = consent
        self._declined = False
        # No lock is needed: appending to a deque, taking from it, and replacing a tuple are single steps of the
        # interpreter.
        self._events: deque[ReceivedEvent] = deque()
        self._requested: tuple[ParticipantRequest, ...] = ()
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="link", daemon=True)

    # Methods that the window calls

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
        """Replace the open requests. The link sends each request again until the server grants the request."""
        self._requested = requests

    def decline(self) -> None:
        """Report to the server that the participant declines to take part.

        The link sends this message even if `stop` is called at once.
        """
        self._declined = True

    # Methods of the thread

    def _run(self) -> None:
        asyncio.run(self._converse())

    async def _converse(self) -> None:
        player = _WindowPlayer()
        # After a crash, the window opens again with the same token. Random numbers distinguish its requests from the
        # requests before the crash.
        role = TabUI(player, self, self._consent, 1 + secrets.randbelow(_FIRST_NUMBERS))
        role.run = self._token
        runner = _ClockedRole(role, self._report)
        async with self._client.running():
            is_last = False
            while not is_last:
                is_last = self._stopped.is_set()
                if self._declined:
                    role.decline()
                if player.requested != self._requested:
                    player.requested = self._requested
                    role.poll_player()
                exchange(runner, self._client, self._report)
                await asyncio.sleep(POLL_PERIOD)

    def observe(self, level: ParticipantUpdate) -> None:
        """Pass a received message on to the window; see `thbridge.roles.participant.tabui.ParticipantObserver`."""
        self._report(level)

    def _report(self, event: ServerEvent) -> None:
        self._events.append(ReceivedEvent(time.monotonic(), event))


class _WindowPlayer:
    """Player that returns the requests of the window."""

    def __init__(self) -> None:
        self.requested: tuple[ParticipantRequest, ...] = ()

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        return self.requested


class _ClockedRole:
    """Role whose steps follow the wall clock. It informs the window when the server is reached."""

    def __init__(self, role: TabUI, report: Callable[[ServerEvent], None]) -> None:
        self._role = role
        self._report = report
        self._begin = time.monotonic()
        self._messages: list[TextMessage] = []

    def connected(self) -> None:
        """See `RoleRunner`, also for the next two methods."""
        self._role.connected()
        self._report(ServerReached())

    def receive(self, message: TextMessage) -> None:
        """Keep a message for the next step."""
        self._messages.append(message)

    def step(self) -> Sequence[TextMessage]:
        """Return the role's replies to all messages received so far."""
        messages, self._messages = self._messages, []
        return self._role.step(int((time.monotonic() - self._begin) / TICK), messages)
