"""Simulation of one game of a sweep, without sockets and clocks. `thbridge play` with the same study and seed plays the
same game."""

from collections.abc import Callable, Sequence

from thbridge.app.compose.game import build_participants
from thbridge.app.compose.recording import build_record, build_recorder, message_filter
from thbridge.app.compose.session import SessionRecording, build_programs, open_session
from thbridge.app.compose.setting import StudySetting
from thbridge.app.play import PLAY, EndCondition, outcome_of
from thbridge.app.run_statistics import RunStatistics
from thbridge.app.session.broadcast import Listener
from thbridge.app.session.session import TickRecorder
from thbridge.batch.measures import GameMeasures, GameObserver
from thbridge.recording.digest import MessageDigest
from thbridge.roles.shared.role import Role
from thbridge.ros.topics import RosMessage
from thbridge.study.study_file import RecordingSection


def play_hunt(
    setting: StudySetting,
    max_seconds: float,
    listeners: Sequence[Listener] = (),
    recorders: Sequence[TickRecorder] = (),
    participants: Sequence[Role] | None = None,
) -> GameMeasures:
    """Play a complete game with the study's simulated participants.

    Args:
        setting: the study with its files.
        max_seconds: simulated time after which an unfinished game stops.
        listeners: objects that receive all messages of the session. Without listeners, no messages are created.
        recorders: objects that receive every tick.
        participants: the participants. If None, a simulated participant plays in each seat.
    """
    study, observer, statistics = setting.study, GameObserver(), RunStatistics()
    who = study.participant
    programs = build_programs(setting, build_participants(setting) if participants is None else participants)
    all_recorders: list[TickRecorder] = [observer, *recorders]
    if listeners:
        opening = build_record(setting, PLAY, programs.names, who.strategy)
        all_recorders.append(build_recorder(setting, opening, listeners))
    session = open_session(setting, programs, SessionRecording(all_recorders))
    ending = EndCondition(max_seconds)
    while True:
        now = session.step()
        if now.snapshot is not None:
            statistics.add(now.snapshot)
        if ending.reached(session):
            break
    return observer.measures(outcome_of(setting, session, ending, 0.0, None, statistics))


class RecordedDigest:
    """Digest of a session's messages. `thbridge bag info --hash` prints the same digest for the bag of ROS 1.

    Args:
        recording: options of the recording. These options may exclude messages.
    """

    def __init__(self, recording: RecordingSection) -> None:
        self._keep = message_filter(recording.detail, errors=recording.errors)
        self._digest = MessageDigest()
        self._fetch: Callable[[], None] | None = None

    def fetch_with(self, fetch: Callable[[], None]) -> None:
        """See `PatientListener`."""
        self._fetch = fetch

    @property
    def is_due(self) -> bool:
        """See `PatientListener`."""
        return False

    def take(self, tick: int, messages: Sequence[RosMessage]) -> None:
        """See `Listener`."""
        for message in self._keep(messages):
            self._digest.add(message.topic.name, message.topic.msgtype, message.stamp_ns, message.data)

    def hexdigest(self) -> str:
        """Return the digest of all messages so far."""
        if self._fetch is not None:
            self._fetch()
        return self._digest.hexdigest()
