"""Recording for the researcher's window: the scene at any moment, and the complete log."""

from bisect import bisect_right
from collections.abc import Callable, Collection, Generator, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from sim.common.grid import OccupancyGrid
from thbridge.files.map_files import MapRoom
from thbridge.hunt.rooms import RoomNames
from thbridge.recording.bag.reading.index import BagIndex, MessageLocation, open_index
from thbridge.recording.bag.reading.reader import RawMessage
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros.messages.session_records import SessionRecord
from ui.model.watching.frames import HORIZON_NS, children_of
from ui.model.watching.messages import TF_TYPES, WatchedMessage
from ui.model.watching.robots import RobotDiscovery
from ui.model.watching.scene import Scene, ShownLayers
from ui.model.watching.scene_builder import SceneBuilder, SceneInputs
from ui.model.watching.series import Series
from ui.model.watching.session_log import SessionLog, is_logged
from ui.sources.numbers import TopicNumbers
from ui.sources.rooms import rooms_of

TICK_NS = 20_000_000
"""Length of a time step in the window, nanoseconds; the same for recordings of other robots."""
_FIRST_FRAMES = 50
"""Number of tf messages that are read to find robots whose odometry is not published."""
_STATIC_MOST = 1000
"""Maximum number of messages of static frames that are read."""
_CHUNKS_KEPT = 512
"""Maximum number of chunks for which the positions of tf messages in the file are stored."""
_MESSAGES_KEPT = 512
"""Maximum number of messages in the cache."""
_PIECE = 100
"""Maximum number of messages in one piece of a scan. Reading a piece takes some milliseconds."""
_LOG_SHARE = 0.1
"""Share of a scan's progress that belongs to the log; the rest belongs to the series."""


def open_bag(path: Path) -> Generator[float, None, "BagSource"]:
    """Open a recording; yield the completed share of the work, so that a caller can show the share or cancel.

    Opening takes half a second or more, mostly in the last piece, so windows open recordings in a thread. This function
    also builds a scene, because only the first scene is slow to build.

    Args:
        path: bag, or name of a split recording.

    Raises:
        BadFile: see `open_index`.
    """
    index = yield from open_index(path)
    source = BagSource(index)
    if source.session is not None:
        source.rooms = rooms_of(source.session, path)
        # Older recordings do not contain the names of rooms.
        source.log.room_names = RoomNames.of((room.room.people, room.name) for room in source.rooms)
    source.scene(source.end_ns, ShownLayers())
    return source


class BagSource:
    """Recording created by `open_bag`; for use in one thread.

    All methods that read the file raise BadFile if the file is damaged or missing.

    Attributes:
        session: description of the session; None if thbridge did not record it.
        log: events, dialogue, messages and inputs, as far as `scan` has read.
        series: numbers over time, as far as `scan` has read.
        rooms: rooms of the map; empty if the map is unknown.
        unreadable: sentences about topics that cannot be read.
        topics: type of each topic that can be drawn, by its name.
        numbers: all topics, and the numbers in their messages.
        map: map that is shown instead of the recorded one. If None, the recorded map is shown.
        start_ns: stamp of the first message.
        end_ns: stamp of the last message.
    """

    def __init__(self, index: BagIndex) -> None:
        self._index = index
        self.start_ns, self.end_ns = index.start_ns, index.end_ns
        self._scenes = SceneBuilder()
        self.unreadable, self.topics = _readable(index)
        self.numbers = TopicNumbers(index)
        self.map: OccupancyGrid | None = None
        self.session = self._session()
        self.rooms: tuple[MapRoom, ...] = ()
        discovery = self._discover()
        self._robots, self._mapped = discovery.robots(), discovery.mapped
        self.log = SessionLog()
        self.series = Series(index.start_ns)
        self.series.follow(self._robots, self._mapped)
        self._statics = [self._index.read(place) for place in self._static_places()]
        self._frame_places: dict[tuple[str, int], dict[bytes, list[MessageLocation]]] = {}
        self._messages: dict[tuple[int, int], RawMessage] = {}

    def close(self) -> None:
        """Close the files."""
        self._index.close()

    def scene(self, at_ns: int, shown: ShownLayers) -> Scene:
        """Return the scene at a time. Earlier or later times give the scene at the first or last message."""
        at_ns = min(max(at_ns, self.start_ns), self.end_ns)
        watched = SceneInputs(self._robots, self._mapped, self.series, self.log, self.rooms, self.start_ns)
        scene = self._scenes.build(_Snapshot(self, at_ns), watched, shown)
        return scene if self.map is None else replace(scene, grid=self.map)

    def step(self, at_ns: int, steps: int) -> int:
        """Return the time `steps` ticks later (earlier if negative), but not outside the recording."""
        return min(max(at_ns + steps * TICK_NS, self.start_ns), self.end_ns)

    def scan(self) -> Iterator[float]:
        """Read all messages for the log, then all messages for the series; yield the completed share of the work.

        Each piece takes some milliseconds. At the end, `log` and `series` are complete.
        """
        logged = [topic for topic, msgtype in self.topics.items() if is_logged(topic, msgtype)]
        yield from self._hand_over(logged, self.log.take, 0.0, _LOG_SHARE)
        moving = [topic for topic, msgtype in self.topics.items() if msgtype in TF_TYPES]
        yield from self._hand_over([*moving, *self.series.topics], self.series.take, _LOG_SHARE, 1.0)

    def _hand_over(
        self, topics: Collection[str], take: Callable[[WatchedMessage], None], start: float, end: float
    ) -> Iterator[float]:
        """Pass all messages of these topics to `take`, in the order of time.

        Yield the completed share of the work, which grows from `start` to `end`.
        """
        chunks = max(self._index.chunks, 1)
        for done, places in enumerate(self._index.walk(topics)):
            for number, place in enumerate(places, start=1):
                take(_Unread(self._index, place))
                if number % _PIECE == 0:
                    yield start + (end - start) * (done / chunks)
            yield start + (end - start) * ((done + 1) / chunks)

    def _session(self) -> SessionRecord | None:
        place = self._index.next(names.SESSION, -1) if names.SESSION in self.topics else None
        try:
            return None if place is None else unpack.session(self._index.read(place).data)
        except ValueError:
            return None

    def _discover(self) -> RobotDiscovery:
        """Find all robots of the recording from the first messages of each topic."""
        discovery = RobotDiscovery(dict(self.topics))
        for topic, msgtype in self.topics.items():
            if msgtype in {types.ODOMETRY, types.OCCUPANCY_GRID} or msgtype in TF_TYPES:
                after_ns = -1
                for _ in range(_FIRST_FRAMES if msgtype in TF_TYPES else 1):
                    place = self._index.next(topic, after_ns)
                    if place is None:
                        break
                    discovery.take(self._index.read(place))
                    after_ns = place.stamp_ns
        return discovery

    def _static_places(self) -> list[MessageLocation]:
        statics = [topic for topic, msgtype in self.topics.items() if msgtype in TF_TYPES and is_static(topic)]
        chunks = ((topic, chunk) for topic in statics for chunk in self._index.chunks_back(topic, self.end_ns, 0))
        return sorted(place for topic, chunk in chunks for place in self._index.locations(topic, chunk))[:_STATIC_MOST]

    def newest(self, topic: str, at_ns: int) -> RawMessage | None:
        """Return the last message of a topic up to a time."""
        place = self._index.last(topic, at_ns) if topic in self.topics else None
        return None if place is None else self._read(place)

    def frames(self, at_ns: int) -> list[WatchedMessage]:
        """Return the messages that define the tf frames at a time, oldest first."""
        held: dict[tuple[str, bytes], RawMessage] = {}
        for message in self._statics:
            if message.stamp_ns <= at_ns:
                held[message.topic, _children(message)] = message
        for topic, msgtype in self.topics.items():
            if msgtype in TF_TYPES and not is_static(topic):
                held.update({(topic, key): message for key, message in self._moving_at(topic, at_ns).items()})
        return sorted(held.values(), key=lambda message: message.stamp_ns)

    def _moving_at(self, topic: str, at_ns: int) -> dict[bytes, RawMessage]:
        """Return, for each moving frame, the last message of a tf topic about this frame, by child frames."""
        held: dict[bytes, MessageLocation] = {}
        for chunk in self._index.chunks_back(topic, at_ns, at_ns - HORIZON_NS):
            for key, places in self._frame_places_in(topic, chunk).items():
                row = bisect_right(places, at_ns, key=lambda place: place.stamp_ns) - 1
                if row >= 0 and places[row].stamp_ns >= at_ns - HORIZON_NS:
                    held[key] = max(places[row], held.get(key, places[row]))
        return {key: self._read(place) for key, place in held.items()}

    def _frame_places_in(self, topic: str, chunk: int) -> dict[bytes, list[MessageLocation]]:
        """Return the positions of a tf topic's messages in a chunk. The keys are the messages' child frames."""
        known = self._frame_places.get((topic, chunk))
        if known is None:
            known = {}
            for place in self._index.locations(topic, chunk):
                known.setdefault(_children(self._index.read(place)), []).append(place)
            if len(self._frame_places) >= _CHUNKS_KEPT:
                self._frame_places.pop(next(iter(self._frame_places)))
            self._frame_places[topic, chunk] = known
        return known

    def _read(self, place: MessageLocation) -> RawMessage:
        """Read a message. A second call returns the same object, so that a message is decoded only once."""
        key = (place.chunk, place.offset)
        known = self._messages.pop(key, None) or self._index.read(place)
        self._messages[key] = known
        if len(self._messages) > _MESSAGES_KEPT:
            self._messages.pop(next(iter(self._messages)))
        return known


class _Unread:
    """Message whose bytes are read on demand, because most uses need only the stamp."""

    __slots__ = ("_index", "_place", "msgtype", "stamp_ns", "topic")

    def __init__(self, index: BagIndex, place: MessageLocation) -> None:
        self._index, self._place = index, place
        self.topic, self.msgtype, self.stamp_ns = place.publisher.topic, place.publisher.msgtype, place.stamp_ns

    @property
    def data(self) -> bytes:
        """Bytes of the message."""
        return self._index.read(self._place).data


class _Snapshot:
    """Last messages of a recording up to one moment."""

    def __init__(self, source: BagSource, at_ns: int) -> None:
        self._source = source
        self.at_ns = at_ns
        self.topics = source.topics

    def newest(self, topic: str) -> WatchedMessage | None:
        return self._source.newest(topic, self.at_ns)

    def frames(self, at_ns: int) -> Sequence[WatchedMessage]:
        return self._source.frames(min(at_ns, self.at_ns))


def _readable(index: BagIndex) -> tuple[tuple[str, ...], dict[str, str]]:
    """Return sentences about topics that cannot be read, and the types of all other topics."""
    problems, topics = {}, {}
    for publisher in index.publishers:
        msgtype = types.TFMESSAGE if publisher.msgtype in TF_TYPES else publisher.msgtype
        try:
            md5 = types.plain_definition(msgtype).md5
        except KeyError:
            continue
        if publisher.md5 != md5:
            problems[publisher.topic] = f"{publisher.topic} has messages of another version of {publisher.msgtype}."
        else:
            topics[publisher.topic] = publisher.msgtype
    return tuple(problems.values()), {topic: topics[topic] for topic in sorted(topics) if topic not in problems}


def _children(message: RawMessage) -> bytes:
    try:
        return children_of(message.data)
    except ValueError:
        return b""


def is_static(topic: str) -> bool:
    """Return True if a tf topic contains static frames."""
    return topic.endswith("tf_static")
