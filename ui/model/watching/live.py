"""State of a running session, updated by its messages as they arrive."""

import math
from bisect import bisect_right
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field

from thbridge.files.map_files import MapRoom
from thbridge.ros import names
from thbridge.ros.messages import unpack
from thbridge.ros.messages.session_records import SessionRecord
from ui.model.watching.decode_cache import DecodeCache
from ui.model.watching.frames import HORIZON_NS, children_of
from ui.model.watching.messages import TF_TYPES, WatchedMessage
from ui.model.watching.robots import RobotDiscovery
from ui.model.watching.scene import Scene, ShownLayers
from ui.model.watching.scene_builder import SceneBuilder, SceneInputs
from ui.model.watching.series import Series
from ui.model.watching.session_log import SessionLog, is_logged

REMEMBERED_NS = 2_000_000_000
"""Nanoseconds for which frames of a running session are kept. A scan is drawn within this time."""
BACK_NS = 1_000_000_000
"""Nanoseconds by which a robot's time must go back to show that another session has begun.

Two sessions with the same study and random seed have equal descriptions, so their times must distinguish them. The
times of latched messages cannot be used, because these can go back further.
"""


@dataclass(slots=True)
class _Snapshot:
    """Last message of each topic, and recent frames by child frame."""

    at_ns: int = 0
    last: dict[str, WatchedMessage] = field(default_factory=dict)
    recent_frames: dict[tuple[str, bytes], deque[WatchedMessage]] = field(default_factory=dict)
    topics: dict[str, str] = field(default_factory=dict)

    def newest(self, topic: str) -> WatchedMessage | None:
        return self.last.get(topic)

    def frames(self, at_ns: int) -> Sequence[WatchedMessage]:
        held = []
        for (topic, _), messages in self.recent_frames.items():
            before = bisect_right(messages, at_ns, key=lambda each: each.stamp_ns) - 1
            # If there is no earlier message, the first later message is used.
            chosen = messages[max(before, 0)]
            if topic.endswith("tf_static") or at_ns - chosen.stamp_ns <= HORIZON_NS:
                held.append(chosen)
        return sorted(held, key=lambda each: each.stamp_ns)

    def take(self, message: WatchedMessage) -> None:
        self.at_ns = max(self.at_ns, message.stamp_ns)
        self.last[message.topic] = message
        self.topics.setdefault(message.topic, message.msgtype)
        if message.msgtype in TF_TYPES:
            frames = self.recent_frames.setdefault((message.topic, children_of(message.data)), deque())
            frames.append(message)
            while len(frames) > 1 and frames[1].stamp_ns < message.stamp_ns - REMEMBERED_NS:
                frames.popleft()


class LiveSource:
    """State of a running session according to the messages received so far; not thread-safe.

    Attributes:
        log: events, dialogue, lines and inputs.
        series: values over time.
        rooms: rooms of the map; the module `ui.sources.rooms` sets this value after `session` is known.
        sessions: number of sessions so far; when a new session begins, all data of the previous session are dropped.
        start_ns: ROS time of the first message.
        joined_ns: ROS time of the first complete tick; None before that tick. The session repeats only a part of its
            earlier messages for a new connection.
        messages: number of received messages.
    """

    def __init__(self) -> None:
        self.rooms: tuple[MapRoom, ...] = ()
        self.sessions = 0
        self._scenes = SceneBuilder()
        self._sessions = DecodeCache[SessionRecord](unpack.session)
        self._received = -math.inf
        # Messages since a session sent its description. The stamp of the robots' first tf message shows if the session
        # is new. If so, all earlier data are dropped, and these messages are processed again.
        self._opening: list[WatchedMessage] | None = None
        self._begin()

    def _begin(self) -> None:
        self.log = SessionLog()
        self.series = Series(0)
        self.start_ns = 0
        self.joined_ns: int | None = None
        self._tf_ns = 0
        self._logged_ns = -1
        self._snapshot = _Snapshot()
        self._discovery = RobotDiscovery()
        self._robots = self._discovery.robots()
        self._new_topics = False
        self._unassigned: list[WatchedMessage] = []
        self.messages = 0

    @property
    def session(self) -> SessionRecord | None:
        """Description of the session; None until it has arrived."""
        return self._sessions.of(self._snapshot.newest(names.SESSION))

    @property
    def end_ns(self) -> int:
        """ROS time of the latest message."""
        return self._snapshot.at_ns

    def take(self, messages: Sequence[WatchedMessage], now: float) -> None:
        """Process messages in order; `now` is monotonic time in seconds."""
        for message in messages:
            self._take(message)
        if messages:
            self._received = now
        # Frames identify the robots. Before the first tf message, messages could be assigned to a wrong robot.
        if self._tf_ns:
            self._assign()

    def stale_for(self, now: float) -> float:
        """Return the seconds since the last message arrived; infinite before the first message."""
        return now - self._received

    def scene(self, shown: ShownLayers) -> Scene:
        """Return the present scene."""
        watched = SceneInputs(self._robots, self._discovery.mapped, self.series, self.log, self.rooms, self.start_ns)
        return self._scenes.build(self._snapshot, watched, shown)

    def _take(self, message: WatchedMessage) -> None:
        if message.topic == names.SESSION:
            before = self._snapshot.newest(names.SESSION)
            if before is not None and before.data != message.data:
                self._begin_another()
            elif before is not None:
                self.series.interrupt(self._snapshot.at_ns)
            self._opening = []
            # After a reconnection, the session repeats entries that the log already contains.
            self._logged_ns = self._snapshot.at_ns if self.messages else -1
        if message.msgtype in TF_TYPES and not message.topic.endswith("tf_static"):
            opening, self._opening = self._opening, None
            if message.stamp_ns < self._tf_ns - BACK_NS:
                self._begin_another()
                for again in opening or ():
                    self._absorb(again)
            self._tf_ns = message.stamp_ns
            if self.joined_ns is None:
                self.joined_ns = message.stamp_ns
        elif self._opening is not None:
            self._opening.append(message)
        self._absorb(message)

    def _begin_another(self) -> None:
        self.sessions += 1
        self._begin()

    def _absorb(self, message: WatchedMessage) -> None:
        if not self.messages:
            self.start_ns = message.stamp_ns
            self.series = Series(message.stamp_ns)
        self.messages += 1
        new = message.topic not in self._snapshot.topics
        try:
            self._snapshot.take(message)
        except ValueError:
            return
        if message.stamp_ns > self._logged_ns and is_logged(message.topic, message.msgtype):
            self.log.take(message)
        if new:
            self._discovery.take(message)
            self._new_topics = True
        self._unassigned.append(message)

    def _assign(self) -> None:
        """Assign messages to robots. The slow search for robots runs only once for all new topics."""
        if self._new_topics:
            self._new_topics = False
            self._robots = self._discovery.robots()
            self.series.follow(self._robots, self._discovery.mapped)
        for message in self._unassigned:
            self.series.take(message)
        self._unassigned.clear()
