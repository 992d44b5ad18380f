"""Replay: a fresh session gets the inputs of a recorded session, and must send the same messages.

A recording is read a tick at a time. The fresh session receives the inputs of the tick through the same methods as the
recorded one. Each message that it sends is compared with the recorded one, bit for bit. The session record is left out:
it contains the versions of the programs, which may have changed since.
"""

from collections import Counter
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby, zip_longest
from pathlib import Path
from typing import Self

from sim.common.observations import TICK, TICKS_PER_SECOND
from thbridge.app.compose.game import build_bot
from thbridge.app.compose.recording import build_record, build_recorder, build_writer, message_filter
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.session import SessionRecording, build_programs, open_session
from thbridge.app.compose.setting import StudySetting
from thbridge.app.play import PLAY
from thbridge.app.programs import SIMR
from thbridge.app.replay.rewordings import reworded
from thbridge.app.session import inputs
from thbridge.app.session.giving import RecordedParticipant, give
from thbridge.app.session.input_records import from_record
from thbridge.app.session.session import Session, TickRecord, TickRecorder
from thbridge.app.session.simr_session import SimrSession
from thbridge.files.errors import BadFile
from thbridge.files.yaml.tree import parse
from thbridge.hunt.codec import kind_of
from thbridge.hunt.events import RoomAdvised
from thbridge.recording.bag.options import RecordingDetail
from thbridge.recording.bag.reading import reader as bag_reader
from thbridge.recording.bag.reading.reader import RawMessage
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.role import Role
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.differences import FieldDifference, differences
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.ros.messages.stamps import START_NS, TICK_NS
from thbridge.ros.topics import P_WRONG, MessageFilter, RosMessage
from thbridge.study.overrides import StudyChange, with_changes
from thbridge.study.robots_from import RobotsFrom
from thbridge.study.study_file import Study, load_study_tree, read_study_text
from thbridge.text_protocol.wire import legacy
from thbridge.timing.loop import run_ticks
from thbridge.timing.pacer import Pacer

BEFORE_THERE_WERE = (StudyChange("robot.amcl.odom_noise_learning_rate", "0"),)
"""Keys that the studies of older recordings lack, with values that reproduce the robots' behavior of that time."""
NOT_IN_OLDER = frozenset({names.ROOMS, names.DIAGNOSTICS, names.ROSOUT})
"""Topics that are not compared if the recording has no names of rooms. Later releases record these names; their
diagnostics and log also name the robot for which another one makes way."""


@dataclass(frozen=True, slots=True)
class Difference:
    """The first message that differs between a replay and its recording.

    Attributes:
        number: number of the message among all compared messages, from 1.
        topic: topic of the recorded message, or of the new one if no message was recorded.
        topic_number: number of the message within its topic, from 1.
        seconds: session time of the message.
        what: one sentence.
        fields: recorded and new values, if both are messages of one type.
    """

    number: int
    topic: str
    topic_number: int
    seconds: float
    what: str
    fields: tuple[FieldDifference, ...]


@dataclass(frozen=True, slots=True)
class Replayed:
    """Result of a replay.

    Attributes:
        ticks: number of ticks run.
        messages: number of messages found equal.
        difference: the first difference; None if all messages were equal.
        cut_off: True when the recording ends in the middle of a tick, and all recorded messages of that tick are equal.
        finished: True when the recording's end or a difference was reached, False when the replay was stopped.
        wall_seconds: real time of the replay.
        reworded: number of messages found equal only in today's words; see `rewordings`.
    """

    ticks: int
    messages: int
    difference: Difference | None
    cut_off: bool
    finished: bool
    wall_seconds: float
    reworded: int = 0


@dataclass(frozen=True, slots=True)
class ReplayOptions:
    """Options of a replay.

    Attributes:
        rate: simulated seconds per second; 0 runs as fast as possible.
        start: session time in seconds. Up to this time, the replay runs as fast as possible, regardless of `rate`.
        to: path of a new recording; None if there is none.
        to_the_end: True to continue after a difference.
        participant: name of a simulated participant that replaces the recorded one. If None, the recorded
            participant's messages are sent again, even if they no longer fit.
    """

    rate: float
    start: float
    to: Path | None
    to_the_end: bool
    participant: str | None = None


@dataclass(frozen=True, slots=True)
class RecordedTick:
    """One tick of a recording: its inputs and all its messages."""

    number: int
    inputs: tuple[inputs.Input, ...]
    messages: tuple[RawMessage, ...]


def session_of(path: Path) -> SessionRecord:
    """Return the session record of a recording.

    Raises:
        BadFile: it cannot be read, thbridge did not record it, another release recorded it, or its robots were real.
    """
    first = next(bag_reader.messages(path, [names.SESSION]), None)
    if first is None:
        problem = f"this bag has no session of thbridge: no topic {names.SESSION}"
        raise BadFile(path, problem, "name a bag that `thbridge play` or `thbridge simr` recorded")
    if first.md5 != types.plain_definition(types.SESSION).md5:
        problem = "another release of this program recorded it, so the same inputs would have other results"
        raise BadFile(path, problem, "replay it with that release", key=names.SESSION)
    try:
        record = unpack.session(first.data)
    except ValueError as error:
        raise BadFile(path, str(error), "name another recording", key=names.SESSION) from None
    if record.program not in {PLAY, SIMR}:
        raise BadFile(path, f"no program is called {record.program!r}", "name another recording", key=names.SESSION)
    if read_study_text(path, record.study).robots_from is RobotsFrom.ROS:
        problem = "its robots were real, and cannot be run again"
        raise BadFile(path, problem, "view it with `thbridge report` or `thbridge bag plot`", key=names.SESSION)
    return record


def recorded_study(path: Path, record: SessionRecord) -> Study:
    """Return the study of a recording, completed by `BEFORE_THERE_WERE` so that robots act as they did.

    Raises:
        BadFile: the recorded study is not valid.
    """
    loaded = load_study_tree(path, parse(path, record.study))
    missing = [change for change in BEFORE_THERE_WERE if change.key not in loaded.lines]
    return with_changes(loaded.value, (), missing) if missing else loaded.value


def _recorded_by(path: Path, record: SessionRecord) -> MessageFilter:
    """Return the filter of the messages that a session recorded, also for studies that are older than its keys."""
    loaded = load_study_tree(path, parse(path, record.study))
    chosen, written = loaded.value.recording, loaded.lines
    detail = chosen.detail if "recording.detail" in written else RecordingDetail.ALL
    keep = message_filter(detail, errors=chosen.errors and "recording.errors" in written)
    if "dialogue.planner" in written:
        return keep
    return lambda messages: keep(message for message in messages if not _is_advice(message))


def _not_in(topics: Collection[str], robots: int) -> frozenset[str]:
    """Return the topics that are not compared because the release that made a recording with `topics` lacked them."""
    older = NOT_IN_OLDER if names.ROOMS not in topics else frozenset()
    p_wrong = frozenset(names.RobotNames.of(robot).topic(P_WRONG) for robot in range(robots))
    return older if p_wrong & set(topics) else older | p_wrong


def _is_advice(message: RosMessage) -> bool:
    return message.topic.name == names.GAME_EVENTS and unpack.game_event(message.data).kind == kind_of(RoomAdvised)


def ticks_of(path: Path) -> Iterator[RecordedTick]:
    """Yield a recording tick by tick. Raises BadFile."""
    for stamp_ns, messages in groupby(bag_reader.messages(path), key=lambda message: message.stamp_ns):
        recorded = tuple(message for message in messages if message.topic != names.SESSION)
        given = tuple(_input(path, message) for message in recorded if message.topic == names.INPUTS)
        yield RecordedTick((stamp_ns - START_NS) // TICK_NS, given, recorded)


def _input(path: Path, message: RawMessage) -> inputs.Input:
    try:
        return from_record(unpack.outside_input(message.data))
    except ValueError as error:
        raise BadFile(path, str(error), "replay it with the release that recorded it", key=names.INPUTS) from None


class RecordingReplay:
    """A recording that is run again, tick by tick; a context manager, which keeps the new recording open.

    Args:
        path: the bag.
        setting: the study to run: the recorded study, or a changed study.
        options: options of the replay.
        progress: called with every tick from `options.start` on.

    Raises:
        BadFile: the bag cannot be read, or the new one cannot be written (as `BagNotWritten`). Methods raise it too.
    """

    def __init__(
        self, path: Path, setting: StudySetting, options: ReplayOptions, progress: Callable[[TickRecord], None]
    ) -> None:
        record = session_of(path)
        fresh = build_record(setting, record.program, record.roles, options.participant or record.participant)
        topics = {topic.name for topic in bag_reader.info(path).topics}
        self._to_the_end = options.to_the_end
        self._comparison = Comparison(_not_in(topics, setting.study.robots))
        self._recorded = ticks_of(path)
        self._over = False
        self._buffer = _MessageBuffer(_recorded_by(path, record))
        with ExitStack() as opened:
            kept = [] if options.to is None else [opened.enter_context(build_writer(setting, options.to))]
            recorder = build_recorder(setting, fresh, [self._buffer, *kept])
            recorders: list[TickRecorder] = [recorder, _ProgressReporter(progress, options.start)]
            self._session, self._give = _replayed_session(setting, record, options.participant, recorders)
            self._opened = opened.pop_all()

    @property
    def tick_number(self) -> int:
        """Number of the next tick."""
        return self._session.tick

    def tick(self) -> bool:
        """Run one tick; return True if another tick follows."""
        was = next(self._recorded, None)
        if was is None:
            self._over = True
            return False
        if was.number > 0:  # The opening messages have tick 0 and come before all steps.
            for item in was.inputs:
                self._give(item)
            self._session.step()
        self._comparison.compare(was.messages, self._buffer.drain())
        self._over = self._comparison.difference is not None and not self._to_the_end
        return not self._over

    def result(self, wall_seconds: float) -> Replayed:
        """Return the result so far; `wall_seconds` is the elapsed real time."""
        done = self._comparison
        return Replayed(
            self._session.tick,
            done.messages,
            done.difference,
            done.cut_off,
            self._over,
            wall_seconds,
            done.reworded,
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *raised: object) -> None:
        self._opened.close()


async def replay(
    path: Path, setting: StudySetting, options: ReplayOptions, progress: Callable[[TickRecord], None]
) -> Replayed:
    """Run a recording again at the rate in `options`, until its end or Ctrl-C; see `RecordingReplay`."""
    with RecordingReplay(path, setting, options, progress) as again:

        def hurried_tick() -> bool:
            return again.tick() and again.tick_number < options.start * TICKS_PER_SECOND

        run = hurried = await run_ticks(hurried_tick, Pacer(0.0))
        if hurried.finished and not again.result(0.0).finished:
            run = await run_ticks(again.tick, Pacer(options.rate))
    wall = hurried.seconds if run is hurried else hurried.seconds + run.seconds
    return replace(again.result(wall), finished=run.finished)


def _replayed_session(
    setting: StudySetting, record: SessionRecord, participant: str | None, recorders: Sequence[TickRecorder]
) -> tuple[Session | SimrSession, Callable[[inputs.Input], None]]:
    """Return a fresh session like the recorded one, and a function that gives it all inputs, also the participant's."""
    if record.program == SIMR:
        alone = SimrSession(build_simr(setting), recorders)
        return alone, partial(_give_to_simr, alone)
    study = setting.study
    recorded_participant = RecordedParticipant() if legacy.TABUI in record.roles and participant is None else None
    player: Role | None = recorded_participant
    if participant is not None:
        player = TabUI(build_bot(setting.templates, participant, study.seed, study.participant.attitude))
    programs = build_programs(setting, player, outside={legacy.HIDER} - set(record.roles))
    session = open_session(setting, programs, SessionRecording(recorders))
    return session, partial(give, session, recorded_participant)


def _give_to_simr(session: SimrSession, item: inputs.Input) -> None:
    """Give an input to a session of `thbridge simr`."""
    match item:
        case inputs.NameAccepted():
            session.connected()
        case inputs.MessageForwarded(message):
            session.receive(message)
        case inputs.ClientRequest(sender, request):
            session.ask(sender, request)


class _ProgressReporter:
    """Recorder that passes tick records on from a start time, in seconds."""

    def __init__(self, progress: Callable[[TickRecord], None], start: float) -> None:
        self._progress = progress
        self._start = start

    def record(self, record: TickRecord) -> None:
        if record.tick * TICK >= self._start:
            self._progress(record)


class _MessageBuffer:
    """Buffer of the messages that a recording keeps, emptied by `drain`."""

    def __init__(self, keep: MessageFilter) -> None:
        self._keep = keep
        self._messages: list[RosMessage] = []

    def take(self, tick: int, messages: Sequence[RosMessage]) -> None:
        self._messages += self._keep(messages)

    def drain(self) -> list[RosMessage]:
        """Return the messages since the last call, without the session record."""
        messages, self._messages = self._messages, []
        return [message for message in messages if message.topic.name != names.SESSION]


class Comparison:
    """Comparison of a replay with its recording, tick by tick.

    Args:
        left_out: topics that are not compared.

    Attributes:
        messages: number of messages found equal.
        reworded: number of messages found equal only in today's words.
        difference: the first difference; None as long as all messages are equal.
    """

    def __init__(self, left_out: frozenset[str] = frozenset()) -> None:
        self._left_out = left_out
        self.messages = self.reworded = 0
        self.difference: Difference | None = None
        self._of_topic: Counter[str] = Counter()
        self._missing: Difference | None = None

    @property
    def cut_off(self) -> bool:
        """True when the recording ends in the middle of its last tick, as after a program was killed."""
        return self._missing is not None

    def compare(self, was: Sequence[RawMessage], now: Sequence[RosMessage]) -> None:
        """Compare the messages of the next tick."""
        if self.difference is not None:
            return
        # At the end of a recording, missing messages are no difference. Here, however, the recording has another tick.
        if self._missing is not None:
            self.difference, self._missing = self._missing, None
            return
        was = [message for message in was if message.topic not in self._left_out]
        now = [message for message in now if message.topic.name not in self._left_out]
        for before, after in zip_longest(was, now):
            if before is None:
                self._missing = self._difference(
                    after.topic.name, after.stamp_ns, "the replay sends it, but it was not recorded"
                )
                return
            self.difference = self._compared(before, after)
            if self.difference is not None:
                return
            self.messages += 1
            self._of_topic[before.topic] += 1

    def _compared(self, was: RawMessage, now: RosMessage | None) -> Difference | None:
        if now is None:
            return self._difference(was.topic, was.stamp_ns, "it was recorded, but the replay does not send it")
        topic, stamp_ns, data, _ = now
        if topic.name != was.topic:
            return self._difference(was.topic, was.stamp_ns, f"the replay sends a message on {topic.name} instead")
        if stamp_ns != was.stamp_ns:
            return self._difference(
                was.topic, was.stamp_ns, f"its time differs by {(stamp_ns - was.stamp_ns) / 1e9:+g} s"
            )
        if data == was.data:
            return None
        if topic.msgtype != was.msgtype or types.plain_definition(topic.msgtype).md5 != was.md5:
            return self._difference(was.topic, was.stamp_ns, f"its type {was.msgtype} is that of another release")
        # Done only here, because it decodes both messages, and nearly all messages are already equal as bytes.
        recorded = reworded(topic.msgtype, was.data, data)
        if data == recorded:
            self.reworded += 1
            return None
        try:
            fields = differences(topic.msgtype, recorded, data)
        except ValueError as error:
            return self._difference(was.topic, was.stamp_ns, f"its content differs; {error}")
        return self._difference(was.topic, was.stamp_ns, "its content differs", fields)

    def _difference(self, topic: str, stamp_ns: int, what: str, fields: tuple[FieldDifference, ...] = ()) -> Difference:
        seconds = (stamp_ns - START_NS) / 1e9
        return Difference(self.messages + 1, topic, self._of_topic[topic] + 1, seconds, what, fields)
