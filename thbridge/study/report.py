"""What a bag tells about a session: where the robots were and believed to be, their energy, the game and the talk.

Made from the messages alone, so it works on foreign bags as far as their topics go, and says what is missing. Times
are seconds since the bag's first message.
"""

import json
import math
from collections import defaultdict
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from functools import partial
from typing import Protocol

import numpy as np

from sim.geometry import FloatArray
from sim.grid import OccupancyGrid
from thbridge.ros import types, unpack
from thbridge.ros.goals import Status
from thbridge.ros.names import THINGS
from thbridge.ros.records import GameEvent, Score, Session, Utterance

OUTCOMES: dict[int, str] = {Status.SUCCEEDED: "arrived", Status.ABORTED: "no path", Status.PREEMPTED: "cancelled"}
UNDER_WAY = "under way"

_TF_OLD = "tf/tfMessage"
"""tf's name for the message, before tf2; the same fields."""


class Recorded(Protocol):
    """A message of a bag."""

    @property
    def topic(self) -> str:
        """Its topic, with a leading slash."""

    @property
    def msgtype(self) -> str:
        """Its type, for example "nav_msgs/Odometry"."""

    @property
    def md5(self) -> str:
        """The sum over the type's fields."""

    @property
    def stamp_ns(self) -> int:
        """When it was recorded, nanoseconds."""

    @property
    def data(self) -> bytes:
        """Its bytes."""


@dataclass(frozen=True, slots=True)
class Leg:
    """A robot's way to one goal.

    Attributes:
        start: seconds.
        end: seconds; the session's end while it was under way.
        outcome: "arrived", "no path", "cancelled" or "under way".
        reason: why it ended so, for people; may be empty.
    """

    start: float
    end: float
    outcome: str
    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class Track:
    """One robot.

    Attributes:
        name: "robot1"; of its namespace.
        truth: (n, 4) time, x, y, theta in the map.
        estimate: (m, 4) likewise, what it believed.
        errors: (m, 3) time, metres, radians (not negative) between the two; empty when either is missing.
        energy: (k, 2) time, energy left, in the game's units, or percent where the bag knows only that.
        legs: its goals in order.
        distance: metres driven; from the truth if there is one, else from what it believed, else from odometry.
    """

    name: str
    truth: FloatArray
    estimate: FloatArray
    errors: FloatArray
    energy: FloatArray
    legs: tuple[Leg, ...]
    distance: float


@dataclass(frozen=True, slots=True, eq=False)
class Thing:
    """Something that stood or walked in the way.

    Attributes:
        name: what people call it.
        outline: (v, 2) closed, where it was seen first; map frame.
        path: (n, 2) the middles of its outlines in order of time; one point if it stood.
    """

    name: str
    outline: FloatArray
    path: FloatArray


@dataclass(frozen=True, slots=True)
class Moment:
    """Something that happened or was said.

    Attributes:
        time: seconds.
        kind: an event's kind, or "said".
        who: "robot1", "participant", or empty.
        room: as people count, or None.
        text: for people.
        points: what it brought or cost, None when that is not its matter.
    """

    time: float
    kind: str
    who: str
    room: int | None
    text: str
    points: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """A session as a reader wants to see it.

    Attributes:
        duration: seconds.
        session: what it was run with; None in foreign bags.
        grid: the map, or None.
        tracks: one a robot, by name.
        things: in the order of their appearance.
        moments: in order of time.
        score: the last one told, or None.
        inputs: how many inputs of people were recorded.
        missing: sentences on what could not be shown, and why.
    """

    duration: float
    session: Session | None
    grid: OccupancyGrid | None
    tracks: tuple[Track, ...]
    things: tuple[Thing, ...]
    moments: tuple[Moment, ...]
    score: Score | None
    inputs: int
    missing: tuple[str, ...]


def read_report(messages: Iterable[Recorded]) -> Report:
    """The report of a bag's messages, oldest first; what cannot be read is left out and told."""
    gathered = _Gathered()
    for message in messages:
        gathered.take(message)
    return gathered.report()


@dataclass(slots=True)
class _Robot:
    """What was heard of one robot so far; rows begin with their time."""

    odom_frame: str = ""
    truth: list[tuple[float, ...]] = field(default_factory=list)
    odometry: list[tuple[float, ...]] = field(default_factory=list)
    amcl: list[tuple[float, ...]] = field(default_factory=list)
    energy: list[tuple[float, float]] = field(default_factory=list)
    goals: dict[str, float] = field(default_factory=dict)
    legs: list[Leg] = field(default_factory=list)


class _Gathered:
    """Messages sorted by what they are about."""

    def __init__(self) -> None:
        self._first_ns: int | None = None
        self._last_ns = 0
        self._robots: defaultdict[str, _Robot] = defaultdict(_Robot)
        self._corrections: defaultdict[str, list[tuple[float, ...]]] = defaultdict(list)
        self._session: Session | None = None
        self._grid: OccupancyGrid | None = None
        self._score: Score | None = None
        self._moments: list[Moment] = []
        self._inputs = 0
        self._outlines: defaultdict[str, list[FloatArray]] = defaultdict(list)
        self._unread: dict[str, str] = {}
        self._takers: dict[str, Callable[[float, str, bytes], None]] = {
            types.ODOMETRY: self._odometry,
            types.TFMESSAGE: self._transforms,
            types.POSE_WITH_COVARIANCE: self._pose,
            types.BATTERY_STATE: self._battery,
            types.MOVE_BASE_GOAL: self._goal,
            types.MOVE_BASE_RESULT: self._result,
            types.OCCUPANCY_GRID: self._map,
            types.SESSION: self._take_session,
            types.SCORE: self._take_score,
            types.MARKER_ARRAY: self._things,
            types.GAME_EVENT: self._event,
            types.UTTERANCE: self._utterance,
            types.INPUT: self._input,
        }

    def take(self, message: Recorded) -> None:
        if self._first_ns is None:
            self._first_ns = message.stamp_ns
        self._last_ns = max(self._last_ns, message.stamp_ns)
        msgtype = types.TFMESSAGE if message.msgtype == _TF_OLD else message.msgtype
        taker = self._takers.get(msgtype)
        if taker is None:
            return
        if message.md5 != types.plain_definition(msgtype).md5:
            self._unread[message.topic] = f"{message.topic} holds another release's {message.msgtype}"
            return
        try:
            taker((message.stamp_ns - self._first_ns) / 1e9, message.topic, message.data)
        except ValueError as error:
            self._unread[message.topic] = f"{message.topic} holds a message that cannot be read: {error}"

    def report(self) -> Report:
        duration = 0.0 if self._first_ns is None else (self._last_ns - self._first_ns) / 1e9
        tracks = tuple(
            self._track(namespace, robot, duration) for namespace, robot in sorted(self._robots.items(), key=_by_number)
        )
        return Report(
            duration,
            self._session,
            self._grid,
            tracks,
            tuple(_thing(name, outlines) for name, outlines in self._outlines.items()),
            tuple(self._moments),
            self._score,
            self._inputs,
            (*self._unread.values(), *self._absent(tracks)),
        )

    def _absent(self, tracks: tuple[Track, ...]) -> Iterable[str]:
        if self._grid is None:
            yield "There is no map: nobody published /map (nav_msgs/OccupancyGrid)."
        if not tracks:
            yield "There are no robots: no topic of type nav_msgs/Odometry."
        without = partial(_names_without, tracks)
        if names := without(lambda track: track.truth):
            yield f"No true path of {names}: no topic base_pose_ground_truth."
        if names := without(lambda track: track.estimate):
            yield f"No estimated path of {names}: neither map -> odom in /tf nor a topic amcl_pose."
        if names := without(lambda track: track.energy):
            yield f"No energy of {names}: no topic of type sensor_msgs/BatteryState."
        if not self._moments:
            yield "No events and no talk: neither /hunt/events nor /dialogue/utterances."
        if self._score is None:
            yield "No score: nobody published /hunt/score."

    def _robot(self, topic: str, levels: int = 1) -> _Robot:
        return self._robots["/".join(topic.split("/")[:-levels])]

    def _odometry(self, time: float, topic: str, data: bytes) -> None:
        said = unpack.odometry(data)
        robot = self._robot(topic)
        row = (time, said.pose.x, said.pose.y, said.pose.theta)
        if topic.endswith("/base_pose_ground_truth"):
            robot.truth.append(row)
        else:
            robot.odom_frame = said.frame.lstrip("/")
            robot.odometry.append(row)

    def _transforms(self, time: float, topic: str, data: bytes) -> None:
        for _, (parent, child, pose) in unpack.transforms(data):
            if parent.lstrip("/") == "map":
                self._corrections[child.lstrip("/")].append((time, pose.x, pose.y, pose.theta))

    def _pose(self, time: float, topic: str, data: bytes) -> None:
        if topic.endswith("/amcl_pose"):
            pose = unpack.pose_with_covariance(data).pose
            self._robot(topic).amcl.append((time, pose.x, pose.y, pose.theta))

    def _battery(self, time: float, topic: str, data: bytes) -> None:
        said = unpack.battery_state(data)
        left = said.charge if math.isfinite(said.charge) else 100.0 * said.percentage
        if math.isfinite(left):
            self._robot(topic).energy.append((time, left))

    def _goal(self, time: float, topic: str, data: bytes) -> None:
        self._robot(topic, levels=2).goals[unpack.move_base_goal(data).goal_id] = time

    def _result(self, time: float, topic: str, data: bytes) -> None:
        said = unpack.move_base_result(data)
        robot = self._robot(topic, levels=2)
        start = robot.goals.pop(said.goal_id, None)
        if start is not None:
            outcome = OUTCOMES.get(said.status, f"status {said.status}")
            robot.legs.append(Leg(start, time, outcome, said.text))

    def _map(self, time: float, topic: str, data: bytes) -> None:
        if topic == "/map":
            self._grid = unpack.occupancy_grid(data)

    def _things(self, time: float, topic: str, data: bytes) -> None:
        if topic == THINGS:
            for name, outline in unpack.outlines(data):
                self._outlines[name].append(outline)

    def _take_session(self, time: float, topic: str, data: bytes) -> None:
        self._session = unpack.session(data)

    def _take_score(self, time: float, topic: str, data: bytes) -> None:
        self._score = unpack.score(data)

    def _event(self, time: float, topic: str, data: bytes) -> None:
        event = unpack.game_event(data)
        who = "" if event.robot is None else f"robot{event.robot + 1}"
        text, points = _told(event)
        self._moments.append(Moment(time, event.kind, who, event.room, text, points))

    def _utterance(self, time: float, topic: str, data: bytes) -> None:
        said: Utterance = unpack.utterance(data)
        who = f"robot{said.robot + 1}" if said.speaker == "robot" else f"participant to robot{said.robot + 1}"
        self._moments.append(Moment(time, "said", who, said.room, said.text or said.move))

    def _input(self, time: float, topic: str, data: bytes) -> None:
        self._inputs += 1

    def _track(self, namespace: str, robot: _Robot, duration: float) -> Track:
        truth, odometry = _rows(robot.truth), _rows(robot.odometry)
        corrections = _rows(self._corrections.get(robot.odom_frame, []))
        estimate = _corrected(odometry, corrections) if len(corrections) else _rows(robot.amcl)
        driven = next((path for path in (truth, estimate, odometry) if len(path)), truth)
        legs = [*robot.legs, *(Leg(start, duration, UNDER_WAY, "") for start in robot.goals.values())]
        return Track(
            namespace.strip("/") or "robot",
            truth,
            estimate,
            _errors(estimate, truth),
            np.array(robot.energy, dtype=np.float64).reshape(-1, 2),
            tuple(sorted(legs, key=lambda leg: leg.start)),
            float(np.hypot(np.diff(driven[:, 1]), np.diff(driven[:, 2])).sum()),
        )


def _by_number(item: tuple[str, _Robot]) -> tuple[int, str]:
    """robot2 before robot10."""
    digits = "".join(sign for sign in item[0] if sign.isdigit())
    return int(digits or 0), item[0]


def _thing(name: str, outlines: list[FloatArray]) -> Thing:
    middles = np.array([outline[:-1].mean(axis=0) for outline in outlines])
    moved = np.hypot(*np.diff(middles, axis=0).T) > 0.0
    return Thing(name, outlines[0], middles[np.concatenate(([True], moved))])


def _names_without(tracks: tuple[Track, ...], part: Callable[[Track], FloatArray]) -> str:
    return ", ".join(track.name for track in tracks if not len(part(track)))


def _rows(rows: list[tuple[float, ...]]) -> FloatArray:
    return np.array(rows, dtype=np.float64).reshape(-1, 4)


def _corrected(odometry: FloatArray, corrections: FloatArray) -> FloatArray:
    """(n, 4) base in map: each odometry pose under the last correction up to its time; earlier ones are left out."""
    last = np.searchsorted(corrections[:, 0], odometry[:, 0], side="right") - 1
    odometry, correction = odometry[last >= 0], corrections[last[last >= 0]]
    c, s = np.cos(correction[:, 3]), np.sin(correction[:, 3])
    x = correction[:, 1] + c * odometry[:, 1] - s * odometry[:, 2]
    y = correction[:, 2] + s * odometry[:, 1] + c * odometry[:, 2]
    return np.column_stack((odometry[:, 0], x, y, _wrapped(correction[:, 3] + odometry[:, 3])))


def _errors(estimate: FloatArray, truth: FloatArray) -> FloatArray:
    """(m, 3) of the estimates within the truth's time, against the truth between its samples."""
    if not len(truth):
        return np.empty((0, 3))
    within = estimate[(estimate[:, 0] >= truth[0, 0]) & (estimate[:, 0] <= truth[-1, 0])]
    times = within[:, 0]
    x, y = np.interp(times, truth[:, 0], truth[:, 1]), np.interp(times, truth[:, 0], truth[:, 2])
    theta = np.interp(times, truth[:, 0], np.unwrap(truth[:, 3]))
    return np.column_stack(
        (times, np.hypot(within[:, 1] - x, within[:, 2] - y), np.abs(_wrapped(within[:, 3] - theta)))
    )


def _wrapped(angles: FloatArray) -> FloatArray:
    wrapped: FloatArray = (angles + np.pi) % (2.0 * np.pi) - np.pi
    return wrapped


def _told(event: GameEvent) -> tuple[str, int | None]:
    """An event for people, from the plain values in its JSON, and its points."""
    try:
        fields = json.loads(event.json)
    except ValueError:
        return event.json, None
    if not isinstance(fields, dict):
        return event.json, None
    told = (
        f"{name.replace('_', ' ')} {_plain(value)}"
        for name, value in fields.items()
        if name not in _SAID_ELSEWHERE and isinstance(value, str | int | float) and not isinstance(value, bool)
    )
    points = fields.get("points")
    return ", ".join(told), points if isinstance(points, int) else None


def _plain(value: str | int | float) -> str:
    """A value within a list: sentences without their stop, numbers without digits that nobody reads."""
    return value.rstrip(".") if isinstance(value, str) else f"{value:g}"


_SAID_ELSEWHERE = frozenset({"v", "event", "robot", "room", "points"})
