"""Request for consent, which the participant's program gets before a session runs and is recorded."""

from collections.abc import Iterable, Mapping, Sequence

from sim.common.observations import TICKS_PER_SECOND
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.session import Programs, open_session
from thbridge.app.compose.setting import StudySetting
from thbridge.credentials import LOCAL, Credentials
from thbridge.roles.keeper.disclosed.consent import ConsentStatus
from thbridge.roles.shared.notices import KEEPER, ParticipantReady
from thbridge.roles.shared.view import DeclineConsent, GiveConsent, View
from thbridge.text_protocol.sockets.server import RouterInterface
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage, encode_line
from thbridge.text_protocol.wire.notice_format import Notice, NoticeDecoder, encode_notice, parse_notice
from thbridge.text_protocol.wire.router import (
    ClientJoined,
    ConnectionId,
    Forwarded,
    RouterOutput,
    SendToClient,
    TurnedAway,
)

_ANSWERS = NoticeDecoder[GiveConsent | DeclineConsent | ParticipantReady](
    GiveConsent | DeclineConsent | ParticipantReady
)


class ParticipantDeclined(Exception):  # noqa: N818 - nothing went wrong with the program
    """Exception: the participant did not agree to take part. Nothing was recorded.

    Attributes:
        answered: True if the participant declined. False if there was no answer, because the participant left or the
            program was stopped.
    """

    def __init__(self, answered: bool) -> None:
        super().__init__("the participant did not agree to take part")
        self.answered = answered


class ConsentDesk:
    """Router of a session that has not started yet; it asks the participant's program for consent.

    The session receives all input as inputs of its first tick, so the consent is its first record. After the answer,
    the desk only passes calls to the session's router. `RouterInterface` describes the methods.

    In a game with several seats, the desk waits for the answers of all given programs. If one participant declines, the
    session does not start.

    Args:
        router: router of a session that runs no ticks before the answer.
        introductions: messages to the program of a participant who joins, by the program's name.

    Attributes:
        status: state of consent.
    """

    def __init__(self, router: RouterInterface, introductions: Mapping[str, Sequence[TextMessage]]) -> None:
        self._router = router
        self._introductions = introductions
        # The one participant of a game without seats may have any program.
        self._has_seats = legacy.TABUI not in introductions
        self._awaited = {*introductions}
        self.status = ConsentStatus.AWAITED

    def make_room(self, now: float) -> Sequence[RouterOutput]:
        """Make room for a connection."""
        return self._router.make_room(now)

    def connect(self, now: float, credentials: Credentials = LOCAL) -> ConnectionId | TurnedAway:
        """Accept a connection."""
        return self._router.connect(now, credentials)

    def receive_data(self, connection: ConnectionId, data: bytes, now: float) -> Sequence[RouterOutput]:
        """Process received bytes; send the consent text to the program of a participant who joins."""
        outputs = self._router.receive_data(connection, data, now)
        replies: list[RouterOutput] = []
        for output in outputs:
            if self.status is not ConsentStatus.AWAITED:
                break
            match output:
                case ClientJoined(_, legacy.TABUI, extended=False) if not self._has_seats:
                    self.status = ConsentStatus.NOT_ASKED
                case Forwarded(message, True, sender_extended=True) if self._is_asked(message):
                    replies += [SendToClient(connection, encode_line(line.line())) for line in self._answer(message)]
        return [*outputs, *replies]

    def admits(self, connection: ConnectionId) -> bool:
        """Return True if a connection may send another line now."""
        return self._router.admits(connection)

    def eof(self, connection: ConnectionId) -> Sequence[RouterOutput]:
        """Remove a connection that has ended."""
        return self._router.eof(connection)

    def report_backlog(self, connection: ConnectionId, size: int) -> Sequence[RouterOutput]:
        """Record the number of bytes that are queued for a connection."""
        return self._router.report_backlog(connection, size)

    def advance(self, now: float) -> Sequence[RouterOutput]:
        """Ping idle connections."""
        return self._router.advance(now)

    def stop(self) -> Sequence[RouterOutput]:
        """Close all connections."""
        return self._router.stop()

    def _answer(self, message: TextMessage) -> Sequence[TextMessage]:
        """Process a message to the keeper, and return the messages to the sender."""
        match _ANSWERS.read(message):
            case GiveConsent():
                self._awaited.discard(self._asked(message))
                if not self._awaited:
                    self.status = ConsentStatus.GIVEN
            case DeclineConsent():
                self.status = ConsentStatus.DECLINED
            case ParticipantReady():
                return self._introductions[self._asked(message)]
        return ()

    def _is_asked(self, message: TextMessage) -> bool:
        """Return True for a message to the keeper of a program whose participant is asked."""
        return message.receiver == KEEPER and self._asked(message) in self._introductions

    def _asked(self, message: TextMessage) -> str:
        """Return the name under which the sender's participant is asked."""
        if self._has_seats or message.sender in (legacy.SIMR, legacy.HIDER):
            return message.sender
        return legacy.TABUI


def introductions(setting: StudySetting, programs: Iterable[str]) -> dict[str, list[TextMessage]]:
    """Return the messages to participants who have not agreed yet: the floor plan, and a view with the consent text.

    The messages are made by a separate session with the same robots, to which no program connects.

    Args:
        setting: the study.
        programs: names of the participants' programs.

    Returns:
        The messages by program.
    """
    newcomers = [_Newcomer(name) for name in sorted(programs)]
    session = open_session(setting, Programs(robots=build_simr(setting), participants=tuple(newcomers)))
    while not all(newcomer.has_view for newcomer in newcomers) and session.tick < TICKS_PER_SECOND:
        session.step()
    return {newcomer.name: newcomer.received for newcomer in newcomers}


class _Newcomer:
    """Participant who joins, but sends no other messages."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.received: list[TextMessage] = []
        self.has_view = False
        self._introduce = False

    def connected(self) -> None:
        """Introduce the participant in the next step."""
        self._introduce = True

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Receive messages; see `Role`."""
        self.received += messages
        notices = [notice for message in messages if isinstance(notice := parse_notice(message), Notice)]
        self.has_view = self.has_view or any(View.of_notice(notice) is not None for notice in notices)
        introduce, self._introduce = self._introduce, False
        return [encode_notice(self.name, KEEPER, ParticipantReady())] if introduce else []
