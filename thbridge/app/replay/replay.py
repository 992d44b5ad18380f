"""Replay: a new session gets the inputs of a recorded session, and must send the same messages.

A recording is read tick by tick. The new session receives the inputs of a tick through the same methods as the recorded
session. Each of its messages is compared with the recorded message, bit for bit. The session record is not compared,
because it contains versions of programs, which may have changed since the recording.
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
from thbridge.app.compose.game import build_participants
from thbridge.app.compose.recording import begin_recording, build_record, build_recorder, message_filter
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
from thbridge.recording.bag.ros2 import has_cdr
from thbridge.roles.shared.role import Role
from thbridge.roles.shared.seat_programs import program_of
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.differences import FieldDifference, differences
from thbridge.ros.messages.session_records import SessionRecord
from thbridge.ros.messages.stamps import START_NS, TICK_NS
from thbridge.ros.topics import P_WRONG, MessageFilter, RosMessage
from thbridge.ros2.recorded_types import RecordedType, recorded_type
from thbridge.study.overrides import StudyChange, with_changes
from thbridge.study.study_file import Study, load_study_tree, read_study_text
from thbridge.text_protocol.wire import legacy
from thbridge.timing.loop import run_ticks
from thbridge.timing.pacer import Pacer

BEFORE_THERE_WERE = (StudyChange("robot.amcl.odom_noise_learning_rate", "0"),)
"""Keys that are missing in the studies of older recordings, with values that reproduce the robots' behavior then."""
NOT_IN_OLDER = frozenset({names.ROOMS, names.DIAGNOSTICS, names.ROSOUT})
"""Topics that are not compared if an older release, without the topic of the rooms' names, made the recording.

Diagnostics and log of later releases also name the robot to which another robot gives way.
"""


@dataclass(frozen=True, slots=True)
class Difference:
    """First difference between a replay and its recording.

    Attributes:
        number: number of the message among all compared messages, from 1.
        topic: topic of the recorded message or, if no message was recorded, of the new message.
        topic_number: number of the message within its topic, from 1.
        seconds: session time of the message.
        what: sentence about the difference.
        fields: recorded and new values, if both messages are of the same type.
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
        ticks: number of ticks of the replay.
        messages: number of equal messages.
        difference: the first difference; None if all messages are equal.
        cut_off: True if the recording ends in the middle of a tick, and all messages up to its end are equal.
        finished: True if the replay has reached a difference or the end; False if it was stopped.
        wall_seconds: real time of the replay, seconds.
        reworded: number of messages that are equal only after old wordings are replaced; see `rewordings`.
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
        rate: simulated seconds per second; 0 means as fast as possible.
        start: session time in seconds up to which the replay runs as fast as possible, regardless of `rate`.
        to: path of a new recording. If None, nothing is recorded.
        to_the_end: True to continue after a difference.
        participant: name of a simulated participant that replaces the recorded participant. If None, the recorded
            participant's messages are sent again, even if they do not fit a changed study.
    """

    rate: float
    start: float
    to: Path | None
    to_the_end: bool
    participant: str | None = None


@dataclass(frozen=True, slots=True)
class RecordedTick:
    """One tick of a recording: inputs and messages."""

    number: int
    inputs: tuple[inputs.Input, ...]
    messages: tuple[RawMessage, ...]


def session_of(path: Path) -> SessionRecord:
    """Return the session record of a recording.

    Raises:
        BadFile: the recording cannot be read, is not by this release of thbridge, or has real robots.
    """
    first = next(bag_reader.messages(path, [names.SESSION]), None)
    if first is None:
        problem = f"this bag is not a recording by thbridge: the topic {names.SESSION} is missing"
        raise BadFile(path, problem, "name a bag that `thbridge play` or `thbridge simr` recorded")
    if first.md5 != types.plain_definition(types.SESSION).md5:
        problem = "another release of thbridge made this recording, so the same inputs would have other results"
        raise BadFile(path, problem, "replay the recording with that release", key=names.SESSION)
    try:
        record = unpack.session(first.data)
    except ValueError as error:
        raise BadFile(path, str(error), "name another recording", key=names.SESSION) from None
    if record.program not in {PLAY, SIMR}:
        problem = f"there is no program with the recorded name {record.program!r}"
        raise BadFile(path, problem, "name another recording", key=names.SESSION)
    if read_study_text(path, record.study).robots_from.is_real:
        problem = "its robots were real, and cannot be run again"
        remedy = "view the recording with `thbridge report` or `thbridge bag plot`"
        raise BadFile(path, problem, remedy, key=names.SESSION)
    return record


def recorded_study(path: Path, record: SessionRecord) -> Study:
    """Return the study of a recording. Keys of `BEFORE_THERE_WERE` are added, so that robots behave as they did.

    Raises:
        BadFile: the recorded study is not valid.
    """
    loaded = load_study_tree(path, parse(path, record.study))
    missing = [change for change in BEFORE_THERE_WERE if change.key not in loaded.lines]
    return with_changes(loaded.value, (), missing) if missing else loaded.value


def _recorded_by(path: Path, record: SessionRecord) -> MessageFilter:
    """Return the filter of the messages that a session recorded, also for studies that lack the filter's keys."""
    loaded = load_study_tree(path, parse(path, record.study))
    chosen, written = loaded.value.recording, loaded.lines
    detail = chosen.detail if "recording.detail" in written else RecordingDetail.ALL
    keep = message_filter(detail, errors=chosen.errors and "recording.errors" in written)
    if "dialogue.planner" in written:
        return keep
    return lambda messages: keep(message for message in messages if not _is_advice(message))


def _not_in(topics: Collection[str], robots: int) -> frozenset[str]:
    """Return the topics that are not compared, because the release that recorded `topics` did not have them."""
    older = NOT_IN_OLDER if names.ROOMS not in topics else frozenset()
    p_wrong = frozenset(names.RobotNames.of(robot).topic(P_WRONG) for robot in range(robots))
    return older if p_wrong & set(topics) else older | p_wrong


def _is_advice(message: RosMessage) -> bool:
    return message.topic.name == names.GAME_EVENTS and unpack.game_event(message.data).kind == kind_of(RoomAdvised)


def ticks_of(path: Path) -> Iterator[RecordedTick]:
    """Yield a recording tick by tick; messages of ROS 2 recordings are CDR. Raises BadFile: it cannot be read."""
    cdr = has_cdr(path)
    for stamp_ns, messages in groupby(bag_reader.messages(path, unchanged=True), key=lambda message: message.stamp_ns):
        recorded = tuple(message for message in messages if message.topic != names.SESSION)
        given = tuple(_input(path, message, cdr) for message in recorded if message.topic == names.INPUTS)
        yield RecordedTick((stamp_ns - START_NS) // TICK_NS, given, recorded)


def _input(path: Path, message: RawMessage, cdr: bool) -> inputs.Input:
    try:
        data = _type_in_ros2(types.INPUT).to_ros1(message.data) if cdr else message.data
        return from_record(unpack.outside_input(data))
    except ValueError as error:
        remedy = "replay the recording with the release that made it"
        raise BadFile(path, str(error), remedy, key=names.INPUTS) from None


def _type_in_ros2(msgtype: str) -> RecordedType:
    return recorded_type(msgtype, types.plain_definition(msgtype).text)


class RecordingReplay:
    """Replay of a recording, tick by tick; a context manager that keeps the new recording open.

    Args:
        path: path of the bag.
        setting: the study to run: the recorded study, or a changed study.
        options: options of the replay.
        progress: callback with each tick from `options.start` on.

    Raises:
        BadFile: the bag cannot be read, or the new bag cannot be written (`BagNotWritten`). All methods can raise it.
    """

    def __init__(
        self, path: Path, setting: StudySetting, options: ReplayOptions, progress: Callable[[TickRecord], None]
    ) -> None:
        record = session_of(path)
        fresh = build_record(setting, record.program, record.roles, options.participant or record.participant)
        topics = {topic.name for topic in bag_reader.info(path).topics}
        self._to_the_end = options.to_the_end
        self._comparison = Comparison(_not_in(topics, setting.study.robots), has_cdr(path))
        self._recorded = ticks_of(path)
        self._over = False
        self._buffer = _MessageBuffer(_recorded_by(path, record))
        with ExitStack() as opened:
            kept = [] if options.to is None else [opened.enter_context(begin_recording(setting, options.to))]
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
        if was.number > 0:  # The first messages have tick 0, and no step belongs to them.
            for item in was.inputs:
                self._give(item)
            self._session.step()
        self._comparison.compare(was.messages, self._buffer.drain())
        self._over = self._comparison.difference is not None and not self._to_the_end
        return not self._over

    def result(self, wall_seconds: float) -> Replayed:
        """Return the result so far; `wall_seconds` is the real time so far."""
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
    """Replay a recording at the rate in `options`, until the end or Ctrl-C; see `RecordingReplay`."""
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
    """Return a new session like the recorded session, and a function that gives an input to the new session."""
    if record.program == SIMR:
        alone = SimrSession(build_simr(setting), recorders)
        return alone, partial(_give_to_simr, alone)
    study = setting.study
    recorded: dict[str, RecordedParticipant] = {}
    players: Sequence[Role] = ()
    if participant is None:
        names = {program_of(seat.name) for seat in study.seats} | {legacy.TABUI}
        recorded = {name: RecordedParticipant(name) for name in record.roles if name in names}
        players = [*recorded.values()]
    else:
        players = build_participants(setting, participant)
    programs = build_programs(setting, players, outside={legacy.HIDER} - set(record.roles))
    session = open_session(setting, programs, SessionRecording(recorders))
    return session, partial(give, session, recorded)


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
    """Recorder that passes tick records to a callback, from a start time (seconds) on."""

    def __init__(self, progress: Callable[[TickRecord], None], start: float) -> None:
        self._progress = progress
        self._start = start

    def record(self, record: TickRecord) -> None:
        if record.tick * TICK >= self._start:
            self._progress(record)


class _MessageBuffer:
    """Buffer of the messages that a recording would contain; `drain` empties the buffer."""

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
        cdr: True if recorded messages are CDR. The session's messages are then converted, and compared bit for bit.

    Attributes:
        messages: number of equal messages.
        reworded: number of messages that are equal only after old wordings are replaced.
        difference: the first difference; None as long as all messages are equal.
    """

    def __init__(self, left_out: frozenset[str] = frozenset(), cdr: bool = False) -> None:
        self._left_out, self._cdr = left_out, cdr
        self.messages = self.reworded = 0
        self.difference: Difference | None = None
        self._of_topic: Counter[str] = Counter()
        self._missing: Difference | None = None

    @property
    def cut_off(self) -> bool:
        """True if the recording ends in the middle of a tick, as after a crash of the program."""
        return self._missing is not None

    def compare(self, was: Sequence[RawMessage], now: Sequence[RosMessage]) -> None:
        """Compare the messages of the next tick."""
        if self.difference is not None:
            return
        # In the last tick of a recording, missing messages are no difference. But the earlier tick was not the last.
        if self._missing is not None:
            self.difference, self._missing = self._missing, None
            return
        was = [message for message in was if message.topic not in self._left_out]
        now = [message for message in now if message.topic.name not in self._left_out]
        for before, after in zip_longest(was, now):
            if before is None:
                self._missing = self._difference(
                    after.topic.name, after.stamp_ns, "the replay sends this message, but it was not recorded"
                )
                return
            self.difference = self._compared(before, after)
            if self.difference is not None:
                return
            self.messages += 1
            self._of_topic[before.topic] += 1

    def _compared(self, was: RawMessage, now: RosMessage | None) -> Difference | None:
        if now is None:
            what = "this message was recorded, but the replay does not send it"
            return self._difference(was.topic, was.stamp_ns, what)
        topic, stamp_ns, _, _ = now
        if topic.name != was.topic:
            what = f"instead of this message, the replay sends a message on {topic.name}"
            return self._difference(was.topic, was.stamp_ns, what)
        if stamp_ns != was.stamp_ns:
            return self._difference(
                was.topic, was.stamp_ns, f"the times differ by {(stamp_ns - was.stamp_ns) / 1e9:+g} s"
            )
        if self._cdr:
            return self._compared_as_cdr(was, now)
        return self._compared_data(was, now)

    def _compared_as_cdr(self, was: RawMessage, now: RosMessage) -> Difference | None:
        theirs = _type_in_ros2(now.topic.msgtype)
        cdr = theirs.from_ros1(now.data)
        if cdr == was.data:
            return None
        try:
            data = theirs.to_ros1(was.data)
        except ValueError as error:
            return self._difference(was.topic, was.stamp_ns, f"the contents differ; {error}")
        # In this direction, fields that ROS 2 does not have become 0. So they are no difference.
        found = self._compared_data(was._replace(data=data), now._replace(data=theirs.to_ros1(cdr)))
        if found is None and theirs.from_ros1(data) != was.data:
            return self._difference(was.topic, was.stamp_ns, "bytes between the fields differ")
        return found

    def _compared_data(self, was: RawMessage, now: RosMessage) -> Difference | None:
        topic, _, data, _ = now
        if data == was.data:
            return None
        if topic.msgtype != was.msgtype or types.plain_definition(topic.msgtype).md5 != was.md5:
            what = f"the type {was.msgtype} has another definition in this release"
            return self._difference(was.topic, was.stamp_ns, what)
        # This comparison is the last, because it decodes both messages. Nearly all messages are equal as bytes.
        recorded = reworded(topic.msgtype, was.data, data)
        if data == recorded:
            self.reworded += 1
            return None
        try:
            fields = differences(topic.msgtype, recorded, data)
        except ValueError as error:
            return self._difference(was.topic, was.stamp_ns, f"the contents differ; {error}")
        return self._difference(was.topic, was.stamp_ns, "the contents differ", fields)

    def _difference(self, topic: str, stamp_ns: int, what: str, fields: tuple[FieldDifference, ...] = ()) -> Difference:
        seconds = (stamp_ns - START_NS) / 1e9
        return Difference(self.messages + 1, topic, self._of_topic[topic] + 1, seconds, what, fields)
