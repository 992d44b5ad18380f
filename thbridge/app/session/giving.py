"""Function that passes recorded inputs to a new session, through the same methods as in the recorded session."""

from collections.abc import Mapping, Sequence

from thbridge.app.session import inputs
from thbridge.app.session.session import Session
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage


class RecordedParticipant:
    """Participant of a replay, which sends the messages of the recorded participant.

    Args:
        name: name of the participant's program.
    """

    def __init__(self, name: str = legacy.TABUI) -> None:
        self.name = name
        self._lines: list[TextMessage] = []

    def connected(self) -> None:
        """Do nothing, because the recorded messages include the participant's introduction."""

    def prompt(self, line: TextMessage) -> None:
        """Queue a message, which the next step sends."""
        self._lines.append(line)

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Return the queued messages; see `Role`."""
        lines, self._lines = self._lines, []
        return lines


def give(session: Session, participants: Mapping[str, RecordedParticipant], item: inputs.Input) -> None:
    """Give an input to a session of `thbridge play`, through the method that received it in the recorded session.

    Args:
        session: the session.
        participants: the recorded participants of the session, by the names of their programs.
        item: the input.
    """
    match item:
        case inputs.ConnectionOpened(_, now, credentials):
            session.perform(session.router.make_room(now))
            session.router.connect(now, credentials)
        case inputs.BytesReceived(connection, _, data, now):
            session.perform(session.router.receive_data(connection, data, now))
        case inputs.ConnectionClosed(connection):
            session.perform(session.router.eof(connection))
        case inputs.ConnectionBacklogged(connection, _, size):
            session.perform(session.router.report_backlog(connection, size))
        case inputs.ClockAdvanced(now):
            session.perform(session.router.advance(now))
        case inputs.ParticipantSent(message) if message.sender in participants:
            participants[message.sender].prompt(message)
        case inputs.ClientRequest(sender, request):
            session.ask(sender, request)
        case inputs.LinkOpened(_, name, robot) if session.has_vehicles:
            session.links.open_link(name, robot)
        case inputs.LinkClosed(link):
            session.links.close_link(link)
        case inputs.FrameReceived(link, _, frame, robot):
            session.transmit(session.links.receive_frame(link, frame, robot).replies)
        case inputs.HeartbeatsSent():
            session.keep_alive()
