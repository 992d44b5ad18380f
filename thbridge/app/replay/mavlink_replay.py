"""Replay of MAVLink frames: a new session gets the frames that a recording's vehicles received, and no other input.

Any bag with topics `/robotN/mavlink/to` is accepted, also a bag by mavros. The robot of the topic receives each frame,
in the tick in which the frame was recorded.
"""

import dataclasses
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from sim.common.observations import TICK, TICKS_PER_SECOND
from sim.common.robot_numbers import RobotNumber, index_of, number_of
from thbridge.app.compose.recording import begin_recording, build_record, build_recorder
from thbridge.app.compose.session import SessionRecording, build_programs, open_session
from thbridge.app.compose.setting import StudySetting
from thbridge.app.play import PLAY
from thbridge.app.session.broadcast import Listener
from thbridge.app.session.mavros import frame_in
from thbridge.app.session.session import Session, TickRecord
from thbridge.files.errors import BadFile
from thbridge.hunt.codec import kind_of
from thbridge.hunt.events import RobotArrived
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.recording.bag.reading import reader as bag_reader
from thbridge.recording.bag.reading.reader import BagInfo
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.session_records import GameEvent
from thbridge.ros.messages.stamps import START_NS, TICK_NS
from thbridge.ros.names import RobotNames
from thbridge.ros.publisher import RosMessage
from thbridge.ros.topics import VehicleTopics
from thbridge.timing.loop import run_ticks
from thbridge.timing.pacer import Pacer

_TOPIC = re.compile(r"(?:/robot([1-9]\d{0,2}))?/mavlink/to")
_LEAD = 1_000_000_000
"""If another program recorded the bag, the game begins this number of nanoseconds before the first message."""


@dataclass(frozen=True, slots=True)
class FramesOptions:
    """Options of a replay of frames.

    Attributes:
        rate: simulated seconds per second; 0 means as fast as possible.
        to: path of a new recording. If None, nothing is recorded.
        longer: duration in seconds for which the session continues after the end of the recording.
    """

    rate: float = 0.0
    to: Path | None = None
    longer: float = 0.0


@dataclass(frozen=True, slots=True)
class Arrival:
    """Arrival of a robot in a room.

    Attributes:
        robot: number of the robot, from 1.
        room: number of the room, from 1.
        seconds: session time of the arrival.
    """

    robot: RobotNumber
    room: int
    seconds: float


@dataclass(frozen=True, slots=True)
class HuntResult:
    """Result of a game.

    Attributes:
        arrivals: arrivals, in order.
        score: points; 0 if there are no points yet.
    """

    arrivals: tuple[Arrival, ...]
    score: int

    @property
    def order(self) -> tuple[tuple[RobotNumber, int], ...]:
        """Pairs of robot and room, in the order of arrival."""
        return tuple((arrival.robot, arrival.room) for arrival in self.arrivals)


@dataclass(frozen=True, slots=True)
class FramesReplayed:
    """Result of a replay of frames.

    Attributes:
        frames: number of frames that vehicles received.
        unusable: number of messages without a frame, or for a robot that does not exist.
        ticks: number of ticks of the replay.
        recorded: result of the recorded game; None if the recording has no game.
        replayed: result of the new session's game.
        compared: number of true poses that were compared with recorded poses.
        parted: session time, in seconds, of the first pose that is not bit-identical; None if all poses are equal.
        finished: True if the end was reached, False if the replay was stopped.
        wall_seconds: real time of the replay, seconds.
    """

    frames: int
    unusable: int
    ticks: int
    recorded: HuntResult | None
    replayed: HuntResult
    compared: int
    parted: float | None
    finished: bool
    wall_seconds: float

    @property
    def same(self) -> bool:
        """True if robots reached the rooms in the recorded order, and the score is the recorded score."""
        was, now = self.recorded, self.replayed
        return was is not None and (was.order, was.score) == (now.order, now.score)


def has_session(path: Path) -> bool:
    """Return True if a bag contains its study. Raises BadFile: the bag cannot be read."""
    return _is_ours(bag_reader.info(path))


def _is_ours(info: BagInfo) -> bool:
    return any(topic.name == names.SESSION for topic in info.topics)


def hunt_result_of(path: Path) -> HuntResult:
    """Return the result of a recorded game. Raises BadFile: the recording cannot be read."""
    arrivals: list[Arrival] = []
    score = 0
    for message in bag_reader.messages(path, [names.GAME_EVENTS, names.SCORE]):
        try:
            if message.topic == names.SCORE:
                score = unpack.score(message.data).score
            else:
                arrivals += _arrival(unpack.game_event(message.data), message.stamp_ns)
        except ValueError as error:
            raise BadFile(path, str(error), "name another recording", key=message.topic) from None
    return HuntResult(tuple(arrivals), score)


def _arrival(event: GameEvent, stamp_ns: int) -> Iterator[Arrival]:
    if event.kind == kind_of(RobotArrived) and event.robot is not None and event.room is not None:
        yield Arrival(number_of(event.robot), event.room, _seconds(stamp_ns))


async def replay_frames(
    path: Path, setting: StudySetting, options: FramesOptions, progress: Callable[[TickRecord], None]
) -> FramesReplayed:
    """Give the frames of a recording to a new session.

    Args:
        path: path of the bag.
        setting: the study; its robots become MAVLink vehicles in any case.
        options: options of the replay.
        progress: callback with each tick.

    Raises:
        BadFile: the bag cannot be read or has no frames, or the new bag cannot be written (`BagNotWritten`).
    """
    setting = _with_vehicles(setting)
    info = bag_reader.info(path)
    frames = _RecordedFrames(path, info)
    last_tick = frames.tick_at(info.end_ns or 0) + round(options.longer * TICKS_PER_SECOND)
    has_hunt = _is_ours(info) and any(topic.name == names.GAME_EVENTS for topic in info.topics)
    recorded = hunt_result_of(path) if has_hunt else None
    # True poses in a bag by another program cannot be compared.
    poses, hunt = _PoseComparison(path, setting.study.robots if _is_ours(info) else 0), _HuntRecorder()
    with ExitStack() as opened:
        listening: list[Listener] = [poses]
        if options.to is not None:
            listening.append(opened.enter_context(begin_recording(setting, options.to)))
        programs = build_programs(setting)
        recorder = build_recorder(setting, build_record(setting, PLAY, programs.names, ""), listening)
        session = open_session(setting, programs, SessionRecording([recorder, hunt]))

        def tick() -> bool:
            frames.give(session, setting.study.robots)
            progress(session.step())
            return session.tick < last_tick

        run = await run_ticks(tick, Pacer(options.rate))
    return FramesReplayed(
        frames=frames.given,
        unusable=frames.unusable,
        ticks=session.tick,
        recorded=recorded,
        replayed=HuntResult(tuple(hunt.arrivals), hunt.score),
        compared=poses.compared,
        parted=poses.parted,
        finished=run.finished,
        wall_seconds=run.seconds,
    )


def _with_vehicles(setting: StudySetting) -> StudySetting:
    study = setting.study
    mavlink = dataclasses.replace(study.mavlink, on=True)
    return dataclasses.replace(setting, study=dataclasses.replace(study, mavlink=mavlink))


class _RecordedFrames:
    """Recorded frames, which the vehicles of the new session receive.

    Attributes:
        given: number of frames that vehicles have received.
        unusable: number of messages without a frame, or for a robot that does not exist.
    """

    def __init__(self, path: Path, info: BagInfo) -> None:
        robots = {topic.name: _robot_of(topic.name) for topic in info.topics if topic.msgtype == types.MAVLINK}
        self._robots = {name: robot for name, robot in robots.items() if robot is not None}
        if not self._robots:
            problem = f"it has no topic {VehicleTopics(RobotNames.of(0)).received.name} of type {types.MAVLINK}"
            raise BadFile(path, problem, "name a recording of robots that were MAVLink vehicles")
        self.given = self.unusable = 0
        self._start_ns = START_NS if _is_ours(info) else (info.start_ns or 0) - _LEAD
        self._messages = bag_reader.messages(path, self._robots.keys())
        self._next = next(self._messages, None)
        self._links: dict[str, LinkId] = {}

    def tick_at(self, stamp_ns: int) -> int:
        """Return the tick that has this stamp in the recording."""
        return (stamp_ns - self._start_ns) // TICK_NS

    def give(self, session: Session, robots: int) -> None:
        """Give the frames up to the next tick to the session; `robots` is the number of robots of the session."""
        while self._next is not None and self.tick_at(self._next.stamp_ns) <= session.tick + 1:
            message, self._next = self._next, next(self._messages, None)
            robot = self._robots[message.topic]
            try:
                received = unpack.mavlink(message.data)
                frame = frame_in(received)
            except ValueError:
                self.unusable += 1
                continue
            if robot >= robots:
                self.unusable += 1
                continue
            self.given += 1
            if received.link not in self._links:
                self._links[received.link] = session.links.open_link(received.link)
            session.transmit(session.links.receive_frame(self._links[received.link], frame, robot).replies)


def _robot_of(topic: str) -> int | None:
    """Return the index of the robot that receives the frames of a topic; None if the topic has no frames.

    Without a number in the topic, the index is 0.
    """
    match = _TOPIC.fullmatch(topic)
    return None if match is None else index_of(int(match[1] or 1))


class _PoseComparison:
    """Comparison of the robots' true poses with a recording.

    Attributes:
        compared: number of compared poses.
        parted: session time of the first pose that differs, seconds; None if all poses are equal.
    """

    def __init__(self, path: Path, robots: int) -> None:
        self.compared = 0
        self.parted: float | None = None
        self._topics = {RobotNames.of(robot).topic("base_pose_ground_truth") for robot in range(robots)}
        self._recorded = bag_reader.messages(path, self._topics)

    def take(self, tick: int, messages: Sequence[RosMessage]) -> None:
        """Compare the poses of a tick; see `Listener`."""
        if self.parted is not None:
            return
        for message in messages:
            if message.topic.name not in self._topics:
                continue
            was = next(self._recorded, None)
            if was is None:
                return
            self.compared += 1
            if (was.topic, was.stamp_ns, was.data) != (message.topic.name, message.stamp_ns, message.data):
                self.parted = _seconds(message.stamp_ns)
                return


class _HuntRecorder:
    """Recorder of the result of a game."""

    def __init__(self) -> None:
        self.arrivals: list[Arrival] = []
        self.score = 0

    def record(self, record: TickRecord) -> None:
        """Record the result after a tick; see `TickRecorder`."""
        for event in record.events:
            if isinstance(event, RobotArrived) and record.snapshot is not None:
                seconds = record.snapshot.tick * TICK
                self.arrivals.append(Arrival(number_of(event.robot), event.room.people, round(seconds, 2)))
        self.score = 0 if record.game is None else record.game.score


def _seconds(stamp_ns: int) -> float:
    return (stamp_ns - START_NS) / 1e9
