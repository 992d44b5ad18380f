"""Connection of a person's front end to a game: their program (TabUI) at the text server, on the wall clock."""

import asyncio
import secrets
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from sim.common.observations import TICK
from thbridge.app.programs import exchange
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.keys.key_file import ClientKey
from thbridge.hunt.seats import PlayedBy
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared.seat_programs import program_of, researchers_program
from thbridge.roles.shared.view import GiveConsent, ParticipantRequest, View
from thbridge.sockets.reconnecting import Backoff, ConnectionLost, LossReason
from thbridge.text_protocol.sockets.client import TextClient
from thbridge.text_protocol.wire.lines import TextMessage

POLL_PERIOD = 0.005
"""Seconds between two polls of the connection.

On average, it delays the drawing of robots by half of this time, and also by the jitter that it adds to pose telemetry.
"""

RECONNECT_BACKOFF = Backoff(initial=0.25, maximum=2.0)
"""Backoff of reconnecting.

It is short, because a person waits: the link connects within two seconds after the server returns.
"""


@dataclass(frozen=True, slots=True)
class ServerReached:
    """Event: the server is reached, or reached again."""


ServerEvent: TypeAlias = ParticipantUpdate | ServerReached | ConnectionLost


@dataclass(frozen=True, slots=True)
class ReceivedEvent:
    """Event with the monotonic time of its arrival, seconds; the front end may take it later."""

    time: float
    event: ServerEvent


_FIRST_NUMBERS = 1 << 31
"""Upper limit of the randomly chosen number of a window's first request."""


class GameConnection:
    """Connection that stays open until it is stopped, and reconnects automatically.

    Args:
        host: host of the server.
        port: port of the server.
        token: id of this run of the program, by which the server recognizes a new connection after a network fault.
        report: function that receives each event, in the order of arrival.
        consent: consent of a participant who has already agreed. If None, the participant has not agreed or was not
            asked.
        key: key to show to the server; None for none.
        seat: name of the person's seat; empty in a game with one participant.
        by: who plays the seat: its participant, or a researcher in their place.

    Raises:
        ValueError: the token is not one word.

    Attributes:
        requested: all open requests; each is sent again until it is granted.
        declined: True if the participant declines; this is sent first, even if the connection is stopped meanwhile.
        present: False while the person is away from their front end; the others in a game with several seats see it.
    """

    def __init__(
        self,
        host: str,
        port: int,
        token: str,
        report: Callable[[ReceivedEvent], None],
        consent: GiveConsent | None = None,
        key: ClientKey | None = None,
        seat: str = "",
        by: PlayedBy = PlayedBy.PERSON,
    ) -> None:
        program = researchers_program(seat) if by is PlayedBy.RESEARCHER else program_of(seat)
        self._client = TextClient(program, token, host, port, RECONNECT_BACKOFF, key)
        self._token = token
        self._seat, self._by = seat, by
        self._consent = consent
        self._report_event = report
        self.requested: tuple[ParticipantRequest, ...] = ()
        self.declined = False
        self.present = True

    async def run(self, stopped: Callable[[], bool], period: float = POLL_PERIOD) -> None:
        """Stay connected until `stopped` returns True; poll the connection after each `period` in seconds."""
        player = _FrontEndPlayer()
        # A window that is opened again after a crash has the same token; random numbers distinguish its requests from
        # earlier ones.
        role = TabUI(player, self, self._consent, 1 + secrets.randbelow(_FIRST_NUMBERS), self._seat, by=self._by)
        role.run = self._token
        runner = _ClockedRole(role, self._report)
        async with self._client.running():
            is_last = False
            while not is_last:
                is_last = stopped()
                if self.declined:
                    role.decline()
                role.present = self.present
                if player.requested != self.requested:
                    player.requested = self.requested
                    role.poll_player()
                exchange(runner, self._client, self._report)
                await asyncio.sleep(period)

    def observe(self, level: ParticipantUpdate) -> None:
        """Pass on a message that the role received; see `thbridge.roles.participant.tabui.ParticipantObserver`."""
        self._report(level)

    def _report(self, event: ServerEvent) -> None:
        self._report_event(ReceivedEvent(time.monotonic(), event))


class _FrontEndPlayer:
    """Player that sends the requests of the front end."""

    def __init__(self) -> None:
        self.requested: tuple[ParticipantRequest, ...] = ()

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        return self.requested


class _ClockedRole:
    """Role that is stepped by the wall clock, and that reports when the server is reached."""

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
        """Return the role's replies to all messages up to this tick."""
        messages, self._messages = self._messages, []
        return self._role.step(int((time.monotonic() - self._begin) / TICK), messages)


def why_lost(texts: Texts, lost: ConnectionLost) -> str:
    """Return a sentence for the participant about a lost connection; empty if the reason is unknown."""
    match lost.reason:
        case LossReason.REFUSED if lost.detail:
            return texts.text("window.server_says", words=lost.detail)
        case LossReason.REFUSED:
            return texts.text("window.played_by_another")
        case LossReason.STOPPED:
            return texts.text("window.server_stopped")
        case LossReason.UNTRUSTED:
            return texts.text("window.other_server")
        case LossReason.UNREACHABLE | LossReason.BROKEN:
            return ""
