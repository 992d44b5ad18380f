"""The participant's program beside its window: a thread of its own speaks with the server.

The window takes what was heard at each frame and says what is wanted; nothing else crosses between the threads.
"""

import asyncio
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from sim.common.observations import TICK
from thbridge.app.programs import exchange
from thbridge.roles.notices import House, Picture, Ways, Whereabouts
from thbridge.roles.tabui import TabUI
from thbridge.roles.view import ParticipantRequest, View
from thbridge.sockets.text_client import Backoff, ConnectionLost, LossReason, TextClient
from thbridge.wire.text import TextMessage

POLL_PERIOD = 0.005
"""Seconds from one look at what has come to the next. Robots are drawn later by half of it, and by what it makes one
telling come later than another."""

RECONNECT_BACKOFF = Backoff(first=0.25, longest=2.0)
"""A person waits at the other end: a server that is back is found within two seconds."""


@dataclass(frozen=True, slots=True)
class ServerReached:
    """The server is reached (again)."""


@dataclass(frozen=True, slots=True)
class ServerLost:
    """The server is not reached any more; why, in words."""

    sentence: str


LOSS_SENTENCES = {
    LossReason.UNREACHABLE: "",
    LossReason.BROKEN: "",
    LossReason.REFUSED: "Somebody else plays it just now.",
    LossReason.STOPPED: "Its server has stopped.",
}
"""What there is to add, for people who play, when the connection is lost."""

ServerEvent: TypeAlias = View | House | Whereabouts | Ways | Picture | ServerReached | ServerLost


@dataclass(frozen=True, slots=True)
class ReceivedEvent:
    """Something, and when it came: monotonic seconds, however much later the window looks."""

    time: float
    event: ServerEvent


class ParticipantLink:
    """Keeps a participant's program connected to a server, until it is stopped.

    Args:
        host: of the server.
        port: of the server.
        token: marks this run of the program, so that the server knows its own connection from before a fault.
    """

    def __init__(self, host: str, port: int, token: str) -> None:
        self._address = (host, port)
        self._token = token
        # Appending to a deque, taking from it and replacing a tuple are single steps of the interpreter.
        self._events: deque[ReceivedEvent] = deque()
        self._requested: tuple[ParticipantRequest, ...] = ()
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="link", daemon=True)

    # The window's side

    def start(self) -> None:
        """Begin to connect."""
        self._thread.start()

    def stop(self) -> None:
        """Leave the server; returns when that is done."""
        self._stopped.set()
        self._thread.join()

    def take_events(self) -> list[ReceivedEvent]:
        """What was heard since the last call, oldest first."""
        return [self._events.popleft() for _ in range(len(self._events))]

    def request(self, wishes: tuple[ParticipantRequest, ...]) -> None:
        """This is all that is wanted from now on; it is said again and again until it is granted."""
        self._requested = wishes

    # The thread's side

    def _run(self) -> None:
        asyncio.run(self._converse())

    async def _converse(self) -> None:
        player = _WindowPlayer()
        role = TabUI(player, self)
        lodger = _ClockedRole(role, self._tell)
        client = TextClient(role.name, self._token, *self._address, RECONNECT_BACKOFF)
        async with client.running():
            while not self._stopped.is_set():
                if player.requested != self._requested:
                    player.requested = self._requested
                    role.poll_player()
                exchange(lodger, client, self._lost)
                await asyncio.sleep(POLL_PERIOD)

    def observe(self, level: View | House | Whereabouts | Ways | Picture) -> None:
        """The role heard something; see `thbridge.roles.tabui.Onlooker`."""
        self._tell(level)

    def _lost(self, lost: ConnectionLost) -> None:
        self._tell(ServerLost(LOSS_SENTENCES[lost.reason]))

    def _tell(self, news: ServerEvent) -> None:
        self._events.append(ReceivedEvent(time.monotonic(), news))


class _WindowPlayer:
    """A player who wants what the window says."""

    def __init__(self) -> None:
        self.requested: tuple[ParticipantRequest, ...] = ()

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        return self.requested


class _ClockedRole:
    """Runs the role by the clock, as often as it is asked, and tells the window, too, that the server is reached."""

    def __init__(self, role: TabUI, tell: Callable[[ServerEvent], None]) -> None:
        self._role = role
        self._tell = tell
        self._begin = time.monotonic()
        self._messages: list[TextMessage] = []

    def connected(self) -> None:
        """See `Lodger`, for this and the next two."""
        self._role.connected()
        self._tell(ServerReached())

    def receive(self, message: TextMessage) -> None:
        """It is passed on with the next step."""
        self._messages.append(message)

    def step(self) -> Sequence[TextMessage]:
        """What the role says to what has come until this tick."""
        messages, self._messages = self._messages, []
        return self._role.step(int((time.monotonic() - self._begin) / TICK), messages)
