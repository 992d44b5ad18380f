"""Search in a bag for the input data of localization: scans, odometry, and the mounting of the laser."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

from sim.common.geometry import Pose2
from thbridge.files.errors import BadFile
from thbridge.offline.laser import Laser, usable
from thbridge.offline.odometry import OdometryTrack
from thbridge.recording.bag.reading.reader import RawMessage, TopicInfo, info, messages
from thbridge.ros.frames import FrameTree, PlanarMount
from thbridge.ros.messages import unpack
from thbridge.ros.messages.plausible import is_plausible
from thbridge.ros.messages.types import LASER_SCAN, ODOMETRY, TFMESSAGE
from thbridge.ros.messages.unpack import LaserScan
from thbridge.ros.names import frame_name
from thbridge.ros.odometry_faults import OdometrySample, fault_sentences
from thbridge.ros.robots import ODOM_FRAME, is_odom_frame, is_truth, namespace_of, owner_of, usual_first

T = TypeVar("T")

TF_TYPES = (TFMESSAGE, "tf/tfMessage")
SCANS = ("scan", "base_scan", "scan_filtered")
"""Usual topics of lasers for localization, the most usual topic first."""
BASE_FRAMES = ("base_footprint", "base_link")
LEVEL = math.radians(10)
"""Maximum tilt of a laser that measures in the plane of the map, radians."""


@dataclass(frozen=True, slots=True, eq=False)
class StampedScan:
    """A scan with its stamp and its time of recording."""

    stamp_ns: int
    received_ns: int
    scan: LaserScan


@dataclass(frozen=True, slots=True, eq=False)
class LocalizationBag:
    """A bag with the input data for localizing a robot.

    Attributes:
        path: the bag.
        scan_topic: topic of the scans.
        messages: number of scans.
        laser: converter of the scans.
        odometry: odometry of the same robot.
        odometry_source: topic of the odometry, or names of the odometry's frames in tf.
        notices: sentences about assumptions and anomalies.
    """

    path: Path
    scan_topic: str
    messages: int
    laser: Laser
    odometry: OdometryTrack
    odometry_source: str
    notices: tuple[str, ...]

    def scans(self) -> Iterator[StampedScan]:
        """Yield every scan in the order of recording. Raise BadFile if the bag is damaged."""
        return _scans(self.path, self.scan_topic)


def open_recording(
    path: Path,
    scan_topic: str | None,
    odom_topic: str | None,
    laser_in_base: Pose2 | None,
    max_odom_speed: float | None = None,
) -> LocalizationBag:
    """Find scans, odometry and the laser's mounting in a bag.

    Args:
        path: a ROS 1 bag.
        scan_topic: topic of type sensor_msgs/LaserScan. If None, use the topic of the only robot.
        odom_topic: topic of type nav_msgs/Odometry. If None, use the topic of the same robot. If there is no such
            topic, odometry is read from tf.
        laser_in_base: pose of the laser on the base. If None, it is read from tf.
        max_odom_speed: speed that the robot cannot exceed, m/s. If None, it is estimated from its odometry.

    Raises:
        BadFile: the bag cannot be read, or does not contain required data. The message lists suitable topics.
    """
    topics = info(path).topics
    notices: list[str] = []
    scan_name = scan_topic or _only_scans(path, topics, notices)
    scans = _topic(topics, scan_name, (LASER_SCAN,))
    if scans is None:
        problem = f"the bag has no scans on {scan_name}; {_offer(topics, (LASER_SCAN,))}"
        raise BadFile(path, problem, "give the topic with --scan-topic")
    first = next((read.scan for read in _scans(path, scans.name) if usable(read.scan)), None)
    if first is None:
        problem = "no scan has two or more beams with an angle between them"
        raise BadFile(path, problem, "give another topic with --scan-topic", key=scans.name)

    # Several robots with separate tf topics may use the same frame names. So read only the tf of this robot.
    robot = namespace_of(scans.name)
    tf_topics = [
        topic.name
        for topic in topics
        if topic.msgtype in TF_TYPES and topic.name.strip("/").rpartition("/")[0] in {"", robot}
    ]
    odom_name = odom_topic or _odometry_beside(scans.name, topics, notices)
    odometry = _topic(topics, odom_name, (ODOMETRY,))
    if odometry is not None:
        tree = FrameTree()
        steps, child = _odometry_of_topic(path, odometry.name)
        source = odometry.name
        bases = _base_names(child, first.frame)
        if laser_in_base is None:
            tree = _frames(path, tf_topics, lambda tree: _mount(tree, first.frame, bases) is not None)
    else:
        tree = _frames(path, tf_topics, lambda tree: _odom_edge(tree, first.frame, certain=True) is not None)
        edge = _odom_edge(tree, first.frame, certain=False)
        if edge is None:
            problem = f"the bag has no odometry on {odom_name} or in tf; {_offer(topics, (ODOMETRY,))}"
            raise BadFile(path, problem, "give the topic with --odom-topic")
        steps = _odometry_of_tf(path, tf_topics, edge)
        source = f"tf {edge[0]} -> {edge[1]}"
        bases = (edge[1],)
        notices.append(f"There is no odometry on {odom_name}, so {source} is used.")
    track = OdometryTrack(steps, max_odom_speed)
    if not len(track):
        raise BadFile(path, "the topic contains no odometry", "give another topic with --odom-topic", key=source)
    if track.unstamped:
        notices.append(unstamped_sentence(source, track.unstamped))
    notices += fault_sentences(source, track.faults, track.begin_ns)

    if laser_in_base is None:
        mount = _mount(tree, first.frame, bases)
        if mount is None:
            frame = frame_name(first.frame)
            problem = f"tf has no transform from the laser {frame!r} to {' or '.join(bases)}"
            raise BadFile(path, problem, "give the pose with --laser-pose X Y YAW")
        if mount.tilt > LEVEL:
            degrees = round(math.degrees(mount.tilt))
            notices.append(f"The laser is tilted by {degrees} degrees. The program ignores this tilt.")
        if mount.upside_down:
            notices.append("The laser is mounted upside down.")
    else:
        mount = PlanarMount(laser_in_base, upside_down=False, tilt=0.0)
    laser = Laser.of(first, mount)
    if laser.mount.range_max != first.range_max:
        notices.append(f"range_max of the scans is {first.range_max}, so {laser.mount.range_max:g} m is used.")
    return LocalizationBag(path, scans.name, scans.messages, laser, track, source, tuple(notices))


def _only_scans(path: Path, topics: tuple[TopicInfo, ...], notices: list[str]) -> str:
    """Return the topic whose messages are laser scans. If a robot has several lasers, return the most usual topic."""
    names = usual_first(_of_type(topics, LASER_SCAN), SCANS)
    robots = sorted({namespace_of(name) for name in names})
    if len(robots) > 1:
        problem = f"the bag contains several robots: {_offer(topics, (LASER_SCAN,))}"
        raise BadFile(path, problem, "give the topic of one robot with --scan-topic")
    if len(names) > 1:
        notices.append(f"The scans of {names[0]} are used. Other topics with scans: {', '.join(names[1:])}.")
    return names[0] if names else f"/{SCANS[0]}"


def _odometry_beside(scans: str, topics: tuple[TopicInfo, ...], notices: list[str]) -> str:
    """Return the odometry topic of the robot with these scans."""
    names = [name for name in _of_type(topics, ODOMETRY) if not is_truth(name)]
    robots = {namespace_of(name) for name in (*names, scans)}
    own = usual_first((name for name in names if owner_of(name, robots) == owner_of(scans, robots)), (ODOM_FRAME,))
    # Odometry in the namespace of a node belongs to the only robot. Then the namespace of the scans does not matter.
    own = own or usual_first((name for name in names if not namespace_of(name)), (ODOM_FRAME,))
    if not own and len(names) == 1 and len({namespace_of(name) for name in _of_type(topics, LASER_SCAN)}) == 1:
        own = names
        notices.append(f"The odometry of {names[0]} is used, because there is no other topic with odometry.")
    if len(own) > 1:
        notices.append(f"The odometry of {own[0]} is used. Other topics with odometry: {', '.join(own[1:])}.")
    namespace = owner_of(scans, robots)
    return own[0] if own else f"/{namespace}/odom" if namespace else "/odom"


def _of_type(topics: tuple[TopicInfo, ...], msgtype: str) -> list[str]:
    return [topic.name for topic in topics if topic.msgtype == msgtype and topic.messages]


def _topic(topics: tuple[TopicInfo, ...], name: str, types: tuple[str, ...]) -> TopicInfo | None:
    wanted = "/" + name.lstrip("/")
    found = (topic for topic in topics if "/" + topic.name.lstrip("/") == wanted)
    return next((topic for topic in found if topic.msgtype in types and topic.messages), None)


def _offer(topics: tuple[TopicInfo, ...], types: tuple[str, ...]) -> str:
    names = _of_type(topics, types[0])
    return f"{types[0]} is on {', '.join(names)}" if names else f"the bag has no {types[0]}"


def _decoded(raw: RawMessage, decode: Callable[[bytes], T], path: Path) -> T:
    try:
        return decode(raw.data)
    except ValueError as error:
        remedy = "record the bag again, or remove the topic from it"
        problem = f"a message on this topic is not a valid {raw.msgtype}: {error}"
        raise BadFile(path, problem, remedy, key=raw.topic) from None


def _scans(path: Path, topic: str) -> Iterator[StampedScan]:
    for raw in messages(path, (topic,)):
        scan = _decoded(raw, unpack.laser_scan, path)
        yield StampedScan(scan.stamp_ns or raw.stamp_ns, raw.stamp_ns, scan)


def unstamped_sentence(topic: str, count: int) -> str:
    """Return the sentence about messages without a stamp."""
    return f"{topic}: {count} messages have the stamp 0, so their time of recording is used."


def _odometry_of_topic(path: Path, topic: str) -> tuple[list[OdometrySample], str]:
    """Return all odometry of a topic, and the child frame of the odometry."""
    steps = []
    child = ""
    for raw in messages(path, (topic,)):
        read = _decoded(raw, unpack.odometry, path)
        child = child or read.child_frame
        steps.append(OdometrySample(raw.stamp_ns, read.stamp_ns, read.pose))
    return steps, child


def _odometry_of_tf(path: Path, topics: list[str], edge: tuple[str, str]) -> list[OdometrySample]:
    return [
        OdometrySample(raw.stamp_ns, stamp_ns, pose)
        for raw in messages(path, topics)
        for stamp_ns, (parent, child, pose) in _decoded(raw, unpack.transforms, path)
        if (frame_name(parent), frame_name(child)) == edge
    ]


def _frames(path: Path, topics: list[str], enough: Callable[[FrameTree], bool]) -> FrameTree:
    """Return the frame tree of a bag. Read the bag only until the tree is sufficient."""
    tree = FrameTree()
    for raw in messages(path, topics):
        transforms = _decoded(raw, unpack.spatial_transforms, path)
        added = [tree.add(each) for each in transforms if is_plausible(*each.position, *each.orientation)]
        if any(added) and enough(tree):
            break
    return tree


def _base_names(child: str, laser: str) -> tuple[str, ...]:
    """Return possible names of the base frame: child frame of the odometry, and usual names with the laser's prefix."""
    prefix = frame_name(laser).rpartition("/")[0]
    usual = [f"{prefix}/{name}" if prefix else name for name in BASE_FRAMES]
    return tuple(dict.fromkeys(name for name in (frame_name(child), *usual) if name))


def _mount(tree: FrameTree, laser: str, bases: tuple[str, ...]) -> PlanarMount | None:
    poses = (tree.pose(laser, base) for base in bases)
    return next((PlanarMount.of(pose) for pose in poses if pose is not None), None)


def _odom_edge(tree: FrameTree, laser: str, certain: bool) -> tuple[str, str] | None:
    """Return the transform from an odometry frame that is above the laser in the tree.

    If there is none and `certain` is False, return the only transform with odometry in the tree.
    """
    chain = tree.chain(laser)
    for child, parent in pairwise(chain):
        if is_odom_frame(parent):
            return parent, child
    edges = [edge for edge in tree.edges() if is_odom_frame(edge[0])]
    return edges[0] if len(edges) == 1 and not certain else None
