"""A session that runs: messages come, and the last ones are how things stand."""

import math
from bisect import bisect_right
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from thbridge.files.map_files import MapRoom
from thbridge.ros import names
from thbridge.ros.messages import unpack
from thbridge.ros.messages.records import SessionRecord
from ui.model.watching.decode_cache import DecodeCache
from ui.model.watching.frames import HORIZON_NS, children_of
from ui.model.watching.messages import TF_TYPES, WatchedMessage
from ui.model.watching.robots import RobotDiscovery
from ui.model.watching.scene import Scene, ShownLayers
from ui.model.watching.scene_builder import SceneBuilder, SceneInputs
from ui.model.watching.series import Series
from ui.model.watching.session_log import SessionLog, is_logged

REMEMBERED_NS = 2_000_000_000
"""How far back frames are known of a session that runs: longer than a scan waits to be drawn."""
BACK_NS = 1_000_000_000
"""Robots whose time goes back so far are another session's. What is latched is as old as it is."""


@dataclass(slots=True)
class _Levels:
    """The last message of each topic, and the frames of the last moments by what they are about."""

    at_ns: int = 0
    last: dict[str, WatchedMessage] = field(default_factory=dict)
    spoken: dict[tuple[str, bytes], deque[WatchedMessage]] = field(default_factory=dict)
    types: dict[str, str] = field(default_factory=dict)

    @property
    def topics(self) -> Mapping[str, str]:
        return self.types

    def newest(self, topic: str) -> WatchedMessage | None:
        return self.last.get(topic)

    def frames(self, at_ns: int) -> Sequence[WatchedMessage]:
        held = []
        for (topic, _), said in self.spoken.items():
            before = bisect_right(said, at_ns, key=lambda each: each.stamp_ns) - 1
            # What was said first after that time is nearer than nothing.
            chosen = said[max(before, 0)]
            if topic.endswith("tf_static") or at_ns - chosen.stamp_ns <= HORIZON_NS:
                held.append(chosen)
        return sorted(held, key=lambda each: each.stamp_ns)

    def take(self, said: WatchedMessage) -> None:
        self.at_ns = max(self.at_ns, said.stamp_ns)
        self.last[said.topic] = said
        if said.topic not in self.types:
            self.types[said.topic] = said.msgtype
        if said.msgtype in TF_TYPES:
            spoken = self.spoken.setdefault((said.topic, children_of(said.data)), deque())
            spoken.append(said)
            while len(spoken) > 1 and spoken[1].stamp_ns < said.stamp_ns - REMEMBERED_NS:
                spoken.popleft()


class LiveSource:
    """A session that runs, as far as its messages have come; for one thread.

    Attributes:
        story: what happened.
        series: numbers over time.
        rooms: of the map; set by whoever can read it (`ui.sources.rooms`) once `session` is known.
        sessions: counts up when another session has taken the place of the one before, and all is forgotten.
    """

    def __init__(self) -> None:
        self.rooms: tuple[MapRoom, ...] = ()
        self.sessions = 0
        self._scenes = SceneBuilder()
        self._sessions = DecodeCache[SessionRecord](unpack.session)
        self._heard = -math.inf
        # What was said since a session introduced itself, until its robots speak: that says which session it is.
        self._opening: list[WatchedMessage] | None = None
        self._begin()

    def _begin(self) -> None:
        self.log = SessionLog()
        self.series = Series(0)
        self._start_ns = 0
        self._tf_ns = 0
        self._levels = _Levels()
        self._introductions = RobotDiscovery()
        self._robots = self._introductions.robots()
        self._newcomers = False
        self._unsorted: list[WatchedMessage] = []
        self._messages = 0

    @property
    def session(self) -> SessionRecord | None:
        """What the session says of itself; None until it has."""
        return self._sessions.of(self._levels.newest(names.SESSION))

    @property
    def start_ns(self) -> int:
        """When time begins: the first message heard."""
        return self._start_ns

    @property
    def end_ns(self) -> int:
        """The latest message heard."""
        return self._levels.at_ns

    @property
    def messages(self) -> int:
        """How many have been taken."""
        return self._messages

    def take(self, said: Sequence[WatchedMessage], now: float) -> None:
        """Take messages, in their order, at a time (monotonic seconds)."""
        for message in said:
            self._take(message)
        if said:
            self._heard = now
        # Robots are told apart by their frames: what comes before those may seem to be of a robot that it is not of.
        if self._tf_ns:
            self._sort()

    def stale_for(self, now: float) -> float:
        """Seconds since the last message came; infinite before the first."""
        return now - self._heard

    def scene(self, shown: ShownLayers) -> Scene:
        """How things stand."""
        watched = SceneInputs(
            self._robots, self._introductions.mapped, self.series, self.log, self.rooms, self._start_ns
        )
        return self._scenes.build(self._levels, watched, shown)

    def _take(self, said: WatchedMessage) -> None:
        if said.topic == names.SESSION:
            self._opening = []
        if said.msgtype in TF_TYPES and not said.topic.endswith("tf_static"):
            opening, self._opening = self._opening, None
            if said.stamp_ns < self._tf_ns - BACK_NS:
                self.sessions += 1
                self._begin()
                for again in opening or ():
                    self._absorb(again)
            self._tf_ns = said.stamp_ns
        elif self._opening is not None:
            self._opening.append(said)
        self._absorb(said)

    def _absorb(self, said: WatchedMessage) -> None:
        if not self._messages:
            self._start_ns = said.stamp_ns
            self.series = Series(said.stamp_ns)
        self._messages += 1
        new = said.topic not in self._levels.types
        try:
            self._levels.take(said)
        except ValueError:
            return
        if is_logged(said.topic, said.msgtype):
            self.log.take(said)
        if new:
            self._introductions.take(said)
            self._newcomers = True
        self._unsorted.append(said)

    def _sort(self) -> None:
        """Give each robot what is told of it; to find out who is who takes a while, and is done once for all topics."""
        if self._newcomers:
            self._newcomers = False
            self._robots = self._introductions.robots()
            self.series.follow(self._robots, self._introductions.mapped)
        for said in self._unsorted:
            self.series.take(said)
        self._unsorted.clear()
