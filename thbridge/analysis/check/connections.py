"""Rules about connections: types, definitions, latching, publishers."""

import re
from collections.abc import Iterator

from thbridge.analysis.check.finding import (
    ALL,
    EVO_TYPES,
    NO_TRAJECTORY,
    TF_TYPES,
    BagStructure,
    BagTool,
    Finding,
    FindingSeverity,
)
from thbridge.analysis.check.reading import fields_of
from thbridge.recording.bag.reading.scan import ConnectionRecord
from thbridge.ros.messages.identification import DefinitionSource, identified, missing_types
from thbridge.ros.messages.types import OCCUPANCY_GRID, OWN_TYPES, md5_of, plain_definition

READERS = (BagTool.ROSBAG, BagTool.FOXGLOVE, BagTool.PLOTJUGGLER)
"""Tools that decode messages with the definition in the bag; rviz and evo use their own definitions."""
LIVE = (BagTool.ROSBAG, BagTool.RVIZ)
"""Tools that depend on live messages. rviz shows the messages that `rosbag play` publishes."""
MAP_PERIOD = 5.0
"""A map that is published at least once in this period, seconds, need not be latched."""
_PART = re.compile(r"^={40,}\r?\nMSG: *(\S+)\r?$", re.MULTILINE)


def definition_missing(bag: BagStructure) -> Iterator[Finding]:
    """Find definitions that are empty, incomplete or unreadable; their messages cannot be decoded."""
    for connection in _used(bag):
        problem = None
        missing = missing_types(connection.msgtype, connection.md5, connection.definition)
        try:
            fields_of(connection.msgtype, connection.definition)
            problem = "the definition is empty" if missing else None
        except ValueError as error:
            problem = "the definition has no field" if connection.msgtype in missing else str(error)
        if problem:
            what = f"{connection.msgtype}: {problem}"
            remedy = "record the topic again, with the definitions of all nested types"
            found = identified(connection.msgtype, connection.md5, connection.definition)
            if found is not None and found.source is DefinitionSource.MD5:
                remedy = "run `thbridge bag cut`, which writes the definition that has this md5 sum"
            yield Finding("definition-missing", FindingSeverity.ERROR, READERS, connection.topic, what, remedy)


def connection_incomplete(bag: BagStructure) -> Iterator[Finding]:
    """Find connections without a required field: rosbag and rosbags refuse the whole bag."""
    for connection in _used(bag):
        if connection.lacks:
            what = f"the connection lacks {' and '.join(connection.lacks)}, so rosbag and evo refuse the whole bag"
            remedy = "run `thbridge bag reindex`, which adds the known fields"
            yield Finding("connection-incomplete", FindingSeverity.ERROR, ALL, connection.topic, what, remedy)


def definition_twice(bag: BagStructure) -> Iterator[Finding]:
    """Find definitions that contain two different definitions of a type: Foxglove refuses the bag."""
    for connection in _used(bag):
        parts = _PART.split(connection.definition)[1:]
        texts: dict[str, set[str]] = {}
        for name, text in zip(parts[::2], parts[1::2], strict=True):
            texts.setdefault(name, set()).add(text.strip())
        twice = sorted(name for name, found in texts.items() if len(found) > 1)
        if twice:
            what = f"the definition has two different texts for {', '.join(twice)}"
            remedy = "record the topic again, with one definition for each type"
            yield Finding(
                "definition-twice", FindingSeverity.ERROR, (BagTool.FOXGLOVE,), connection.topic, what, remedy
            )


def md5_wrong(bag: BagStructure) -> Iterator[Finding]:
    """Find wrong md5 sums, and types of other ROS versions: subscribers compare the sums and refuse both."""
    for connection in _used(bag):
        given = md5_of(connection.msgtype, connection.definition) if connection.definition.strip() else None
        if given is not None and connection.md5 not in (given, "*"):
            what = f"the md5 of {connection.msgtype} is {connection.md5}, but the definition gives {given}"
            remedy = "repair the bag with `rosrun rosbag fix_msg_defs.py`, or record the topic again"
            yield Finding("md5-wrong", FindingSeverity.ERROR, LIVE, connection.topic, what, remedy)
            continue
        try:
            ours = plain_definition(connection.msgtype).md5
        except KeyError:
            continue
        # The types of thbridge may change between versions; this does not concern ROS's tools.
        if connection.msgtype not in OWN_TYPES and connection.md5 not in (ours, "*") and given is not None:
            what = f"{connection.msgtype} has different fields than in ROS Noetic"
            remedy = "migrate the bag with `rosbag fix`"
            tools = bag.tools_of(connection.topic, (BagTool.RVIZ, BagTool.EVO))
            yield Finding("other-release", FindingSeverity.WARNING, tools, connection.topic, what, remedy)


def latching_word(bag: BagStructure) -> Iterator[Finding]:
    """Find values of latching other than 0 and 1: rosbag latches only for 1; evo (rosbags) requires a number."""
    for connection in _used(bag):
        if connection.latching not in (None, "", "0", "1"):
            what = f"latching is {connection.latching!r}: `rosbag play` does not latch it, and rosbags refuses the bag"
            tools = (BagTool.ROSBAG, BagTool.EVO)
            remedy = "run `thbridge bag reindex`, which replaces this value by 0"
            yield Finding("latching-word", FindingSeverity.ERROR, tools, connection.topic, what, remedy)


def unlatched(bag: BagStructure) -> Iterator[Finding]:
    """Find maps and static transforms that are not latched: late subscribers miss them."""
    for topic, connections in bag.connections_by_topic().items():
        latched = all(connection.latched for connection in connections)
        types = {connection.msgtype for connection in connections}
        messages = sum(bag.counts[connection.number] for connection in connections)
        rare = messages * MAP_PERIOD <= max(bag.seconds, MAP_PERIOD)
        is_static = topic.endswith("tf_static") and not types.isdisjoint(TF_TYPES)
        if latched or not (is_static or (OCCUPANCY_GRID in types and rare)):
            continue
        severity = FindingSeverity.ERROR if is_static or topic.endswith("/map") else FindingSeverity.WARNING
        what = "the topic is not latched: rviz misses its message if it starts later, or after a seek during play"
        remedy = "record it from a publisher that latches, with latching=1 in the connection"
        yield Finding("unlatched", severity, LIVE, topic, what, remedy)


def two_latched(bag: BagStructure) -> Iterator[Finding]:
    """Find latched topics with several publishers: many tools keep only the last message of a topic.

    Source: ros_comm 1.15 (Noetic) latches each publisher. Earlier releases of roscpp latch each topic of a node, and
    `rosbag play` is one node. Foxglove reads one message of each topic after a seek (BagIterableSource.ts).
    """
    for topic, connections in bag.connections_by_topic().items():
        # All nodes latch /rosout; losing old log lines does no harm.
        if connections[0].msgtype == "rosgraph_msgs/Log" or len(connections) < 2:
            continue
        if topic.endswith("tf_static") or any(connection.latched for connection in connections):
            severity = FindingSeverity.ERROR if topic.endswith("tf_static") else FindingSeverity.WARNING
            names = ", ".join(connection.caller or "?" for connection in connections)
            what = (
                f"{len(connections)} publishers latch this topic ({names}). In `rosbag play` before Noetic, and in "
                "Foxglove after a seek, the message of one publisher replaces all others"
            )
            remedy = "publish all data in one message, by one publisher"
            tools = (*LIVE, BagTool.FOXGLOVE)
            yield Finding("two-latched", severity, tools, topic, what, remedy)


def two_types(bag: BagStructure) -> Iterator[Finding]:
    """Find topics with more than one type."""
    for topic, connections in bag.connections_by_topic().items():
        kinds = sorted({f"{connection.msgtype} {connection.md5[:8]}" for connection in connections})
        if len(kinds) > 1:
            what = f"the publishers of this topic disagree on its type: {', '.join(kinds)}"
            tools = (BagTool.ROSBAG, BagTool.RVIZ, BagTool.FOXGLOVE, BagTool.EVO)
            yield Finding("two-types", FindingSeverity.ERROR, tools, topic, what, "use a separate topic for each type")


def unused(bag: BagStructure) -> Iterator[Finding]:
    """Find connections without a message: `rosbag info` may give a negative duration for such a bag."""
    for connection in bag.connections.values():
        if not bag.counts.get(connection.number) and not bag.unreadable:
            what = "the topic has a connection but no messages"
            remedy = "register a topic with its first message; `thbridge bag cut` removes the connection"
            yield Finding("unused", FindingSeverity.WARNING, (BagTool.ROSBAG,), connection.topic, what, remedy)


def unknown_connection(bag: BagStructure) -> Iterator[Finding]:
    """Find messages without a connection record, which have no topic and no type."""
    lost = sum(count for number, count in bag.counts.items() if number not in bag.connections)
    if lost:
        what = f"{lost} messages have no connection record"
        tools = (BagTool.ROSBAG, BagTool.FOXGLOVE, BagTool.PLOTJUGGLER, BagTool.EVO)
        yield Finding(
            "unknown-source", FindingSeverity.ERROR, tools, None, what, "run `thbridge bag reindex`", None, lost
        )


def clock_recorded(bag: BagStructure) -> Iterator[Finding]:
    """Find a recorded /clock. `rosbag play --clock` publishes /clock, too, so time jumps between two clocks."""
    if "/clock" in bag.connections_by_topic():
        what = "this topic is recorded, but `rosbag play --clock` also publishes it"
        remedy = "play only the other topics, or remove /clock with `thbridge bag cut --topics`"
        yield Finding("clock-recorded", FindingSeverity.WARNING, LIVE, "/clock", what, remedy)


def no_trajectory(bag: BagStructure) -> Iterator[Finding]:
    """Find bags without changing poses, which evo cannot use."""
    moving = [source for source in bag.connections.values() if not source.topic.endswith("tf_static")]
    types = {source.msgtype for source in moving if bag.counts.get(source.number)}
    if any(bag.counts.values()) and types.isdisjoint(EVO_TYPES):
        what = f"no topic contains a trajectory: evo reads only {', '.join(EVO_TYPES)}"
        yield Finding(NO_TRAJECTORY, FindingSeverity.NOTE, (BagTool.EVO,), None, what, "also record odometry or tf")


def _used(bag: BagStructure) -> Iterator[ConnectionRecord]:
    """Yield the connections that have messages; of several connections with equal contents, yield only one."""
    seen = set()
    for connection in bag.connections.values():
        kind = (connection.topic, connection.msgtype, connection.md5, connection.definition, connection.latching)
        if bag.counts.get(connection.number) and kind not in seen:
            seen.add(kind)
            yield connection


RULES = (
    connection_incomplete,
    definition_missing,
    definition_twice,
    md5_wrong,
    latching_word,
    unlatched,
    two_latched,
    two_types,
    unused,
    unknown_connection,
    clock_recorded,
    no_trajectory,
)
