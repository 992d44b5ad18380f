"""Rules about coordinate frames: names, the tree of transforms, and frames of messages outside it.

Source: geometry2, tf2/buffer_core.cpp (transforms that setTransform ignores, errors of lookups).
"""

from collections.abc import Iterator
from dataclasses import dataclass

from thbridge.analysis.check.finding import (
    TF_TYPES,
    BagStructure,
    BagTool,
    CheckedMessage,
    Finding,
    FindingSeverity,
    MessageHandler,
    OccurrenceCounter,
)
from thbridge.recording.bag.reading.scan import ConnectionRecord
from thbridge.ros.names import frame_name

SHOWN = (BagTool.RVIZ, BagTool.FOXGLOVE)
FIXED_FRAMES = ("map", "world", "odom")
"""Frames that tools use as the fixed frame, in this order."""
SHOWN_TYPES = frozenset(
    {"visualization_msgs/Marker"}
    | {f"nav_msgs/{name}" for name in ("GridCells", "OccupancyGrid", "Odometry", "Path")}
    | {f"sensor_msgs/{name}" for name in ("LaserScan", "PointCloud", "PointCloud2", "Range")}
    | {
        f"geometry_msgs/{name}"
        for name in ("PointStamped", "PolygonStamped", "PoseArray", "PoseStamped", "PoseWithCovarianceStamped")
    }
)
"""Message types that tools show at a position in space."""
FRAMELESS_TYPES = frozenset({"mavros_msgs/Mavlink"})
"""Message types whose headers contain names that are not frames, for example the name of a MAVLink link."""
LATE_NS = 1_000_000_000
"""Longest normal time without transforms at the beginning of a recording."""


class SlashedFrames:
    """Rule for frames with a leading slash: tf2 refuses to look up these frames.

    tf2 drops the slash only in transforms. Foxglove drops the slash everywhere.
    """

    def __init__(self) -> None:
        self._slashed: OccurrenceCounter[tuple[str, str]] = OccurrenceCounter()
        self._tf: set[str] = set()

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Check every topic that has frames."""
        topic = source.topic
        if source.msgtype in FRAMELESS_TYPES:
            return None
        if source.msgtype in TF_TYPES:
            self._tf.add(topic)

        def check(message: CheckedMessage) -> None:
            for _, frame in message.reading.headers:
                if frame.startswith("/"):
                    self._slashed.add((topic, frame), message.stamp_ns)
            for frame in message.reading.children:
                if frame.startswith("/"):
                    self._slashed.add((topic, frame), message.stamp_ns)

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each topic and frame."""
        for (topic, frame), first, count in self._slashed.items():
            if topic in self._tf:
                severity, tools, harm = FindingSeverity.WARNING, (BagTool.EVO,), "evo needs this name"
            else:
                severity, tools, harm = (
                    FindingSeverity.ERROR,
                    (BagTool.RVIZ,),
                    "tf2 refuses such names, and rviz shows nothing",
                )
            what = f"the frame {frame!r} begins with a slash: {harm}"
            remedy = f"rename the frame to {frame_name(frame)!r}"
            yield Finding("frame-slash", severity, tools, topic, what, remedy, first, count)


@dataclass(slots=True)
class _Edge:
    """Transform between a child and a parent: its topic, first time stamp, and first message."""

    topic: str
    first_ns: int
    static: bool
    received_ns: int


@dataclass(slots=True)
class _Use:
    """Use of a frame in the messages of a topic: number of messages, and stamps of the first message."""

    received_ns: int
    stamp_ns: int
    shown: bool
    count: int = 0


class TransformTree:
    """Rule for faults in the tree of transforms: gaps, loops, two parents, late transforms."""

    def __init__(self) -> None:
        self._edges: dict[str, dict[str, _Edge]] = {}
        self._above: dict[str, str] = {}
        self._switches: OccurrenceCounter[str] = OccurrenceCounter()
        self._bad: OccurrenceCounter[tuple[str, str]] = OccurrenceCounter()
        self._uses: dict[tuple[str, str], _Use] = {}
        self._unnamed: OccurrenceCounter[str] = OccurrenceCounter()

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Check transforms, and every topic that has frames."""
        if source.msgtype in FRAMELESS_TYPES:
            return None
        return self._transforms(source) if source.msgtype in TF_TYPES else self._users(source)

    def _transforms(self, source: ConnectionRecord) -> MessageHandler:
        topic, static = source.topic, source.topic.endswith("tf_static")

        def check(message: CheckedMessage) -> None:
            for (stamp_ns, parent), child in zip(message.reading.headers, message.reading.children, strict=False):
                above, below = frame_name(parent), frame_name(child)
                if not above or not below or above == below:
                    self._bad.add((topic, f"{parent!r} -> {child!r}"), message.stamp_ns)
                    continue
                parents = self._edges.setdefault(below, {})
                edge = parents.get(above)
                if edge is None:
                    parents[above] = _Edge(topic, stamp_ns, static, message.stamp_ns)
                elif stamp_ns < edge.first_ns:
                    edge.first_ns = stamp_ns
                if self._above.get(below, above) != above:
                    self._switches.add(below, message.stamp_ns)
                self._above[below] = above

        return check

    def _users(self, source: ConnectionRecord) -> MessageHandler:
        topic = source.topic
        shown = source.msgtype in SHOWN_TYPES

        def check(message: CheckedMessage) -> None:
            headers = message.reading.headers
            if not headers:
                return
            if shown and not headers[0][1]:
                self._unnamed.add(topic, message.stamp_ns)
            for stamp_ns, frame in headers if len(headers) < 3 else set(headers):
                if not frame:
                    continue
                use = self._uses.get((topic, frame))
                if use is None:
                    use = self._uses[(topic, frame)] = _Use(message.stamp_ns, stamp_ns or message.stamp_ns, shown)
                use.count += 1

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield faults of the tree, and frames of messages that are not connected to it."""
        for (topic, edge), first, count in self._bad.items():
            what = f"tf2 ignores the transform {edge}, because it needs two different frames"
            remedy = "give both frames different names"
            yield Finding("tf-names", FindingSeverity.ERROR, SHOWN, topic, what, remedy, first, count)
        for topic, first, count in self._unnamed.items():
            what = "the header names no frame, so tools do not know where to show the message"
            remedy = "fill in frame_id in the driver"
            yield Finding("frame-empty", FindingSeverity.ERROR, SHOWN, topic, what, remedy, first, count)
        yield from self._two_parents()
        looped = self._loop()
        if looped is not None:
            yield looped
        else:
            yield from self._hanging()

    def _two_parents(self) -> Iterator[Finding]:
        switches = {child: count for child, _, count in self._switches.items()}
        for child, parents in self._edges.items():
            if len(parents) < 2:
                continue
            names = " and ".join(repr(name) for name in parents)
            last = max(parents.values(), key=lambda edge: edge.received_ns)
            mixed = len({edge.static for edge in parents.values()}) > 1
            # A single change may be intended, for example when a robot hands over an object.
            severity = FindingSeverity.ERROR if mixed or switches.get(child, 0) > 1 else FindingSeverity.WARNING
            what = f"the parent of frame {child!r} alternates between {names}: the tree breaks at each change"
            remedy = "let one publisher send the transform, with one parent"
            first, count = last.received_ns, switches.get(child, 0)
            yield Finding("tf-two-parents", severity, SHOWN, last.topic, what, remedy, first, count)

    def _loop(self) -> Finding | None:
        for start in self._edges:
            chain = [start]
            while (above := self._above.get(chain[-1])) is not None:
                if above in chain:
                    ring = [*chain[chain.index(above) :], above]
                    edge = self._edges[chain[-1]][above]
                    what = f"transforms form a loop: {' -> '.join(ring)}"
                    remedy = "remove one of these transforms"
                    return Finding("tf-loop", FindingSeverity.ERROR, SHOWN, edge.topic, what, remedy, edge.received_ns)
                chain.append(above)
        return None

    def _root(self, frame: str) -> str:
        while frame in self._above:
            frame = self._above[frame]
        return frame

    def _since_ns(self, frame: str) -> int:
        """Return the time from which the frame is connected to its root."""
        since = 0
        while frame in self._above:
            since = max(since, self._edges[frame][self._above[frame]].first_ns)
            frame = self._above[frame]
        return since

    def _fixed(self) -> str | None:
        used = {frame_name(frame) for _, frame in self._uses}
        known = used | set(self._above) | set(self._above.values())
        for name in FIXED_FRAMES:
            if name in known:
                return self._root(name)
        roots = [self._root(frame) for frame in known]
        return max(sorted(set(roots)), key=roots.count) if roots else None

    def _hanging(self) -> Iterator[Finding]:
        fixed = self._fixed()
        if not self._edges:
            yield from self._no_tree()
            return
        for (topic, name), use in self._uses.items():
            frame = frame_name(name)
            if self._root(frame) != fixed:
                what = f"no transform connects the frame {frame!r} to {fixed!r}"
                if self._root(frame) != frame:
                    what += f"; the root of this frame is {self._root(frame)!r}"
                remedy = "also record /tf and /tf_static, including the transform from base to sensor"
                severity = FindingSeverity.ERROR if use.shown else FindingSeverity.WARNING
                yield Finding("tf-missing", severity, SHOWN, topic, what, remedy, use.received_ns, use.count)
            elif (late := self._since_ns(frame) - use.stamp_ns) > 0:
                severity = FindingSeverity.WARNING if late > LATE_NS else FindingSeverity.NOTE
                what = f"the first message is {late / 1e9:.3f} s older than the first transforms of {frame!r}"
                remedy = "start to record the transforms before the sensors"
                yield Finding("tf-late", severity, SHOWN, topic, what, remedy, use.received_ns, 1)

    def _no_tree(self) -> Iterator[Finding]:
        shown = {frame_name(frame): use for (_, frame), use in self._uses.items() if use.shown}
        if len(shown) > 1:
            what = f"there are no transforms in the bag, but the messages are in frames {', '.join(sorted(shown))}"
            first = min(use.received_ns for use in shown.values())
            yield Finding(
                "tf-missing", FindingSeverity.ERROR, SHOWN, None, what, "also record /tf and /tf_static", first
            )


class CompleteStaticTransforms:
    """Rule for static transforms missing in the last message of /tf_static. Late subscribers get only this message."""

    def __init__(self) -> None:
        self._children: dict[int, set[str]] = {}
        self._last: dict[int, tuple[int, set[str]]] = {}

    def listen(self, source: ConnectionRecord) -> MessageHandler | None:
        """Check the topics of static transforms."""
        if source.msgtype not in TF_TYPES or not source.topic.endswith("tf_static"):
            return None
        children_of = self._children.setdefault(source.number, set())

        def check(message: CheckedMessage) -> None:
            children = set(message.reading.children)
            children_of.update(children)
            self._last[source.number] = (message.stamp_ns, children)

        return check

    def findings(self, bag: BagStructure) -> Iterator[Finding]:
        """Yield one finding for each publisher."""
        for number, (stamp_ns, last) in self._last.items():
            lacking = sorted(self._children[number] - last)
            if lacking:
                what = f"the last message lacks {', '.join(lacking)}, and replaces earlier messages that have them"
                remedy = "send all static transforms in one message"
                tools = (BagTool.ROSBAG, BagTool.RVIZ)
                topic = bag.connections[number].topic
                yield Finding("static-partial", FindingSeverity.ERROR, tools, topic, what, remedy, stamp_ns, 1)


RULES = (SlashedFrames, TransformTree, CompleteStaticTransforms)
