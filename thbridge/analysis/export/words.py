"""What the values of messages mean: units, and a few words, for ROS's common types and for ours.

Units are those of REP 103 and of the comments in ROS's definitions. Types that are not here get names and no words.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from thbridge.analysis.export.layout import Path
from thbridge.ros.messages.types import OWN_TEXTS


class Word(NamedTuple):
    """What a field is: the unit of all numbers in it ("" where it has none or is made of several), and its meaning."""

    unit: str
    meaning: str


_XYZ = {"x": Word("m", "along x"), "y": Word("m", "along y"), "z": Word("m", "up")}
_VECTOR = {axis: Word("", axis) for axis in "xyz"}
_STATUS = Word("", "0 pending, 1 active, 2 preempted, 3 succeeded, 4 aborted, 5 rejected, 8 recalled, 9 lost")


def _said(text: str) -> Iterator[tuple[str, Word]]:
    """The comments of a definition, by their fields."""
    for line in text.splitlines():
        declared, _, comment = line.partition("#")
        if words := declared.split():
            yield words[1], Word("", comment.strip())


WORDS: Mapping[str, Mapping[str, Word]] = {
    "std_msgs/Header": {
        "seq": Word("", "number of the message, from its publisher; often 0"),
        "stamp": Word("", "time that the values are of; in ours, simulated time that begins at 1 s"),
        "frame_id": Word("", "frame that the values are in"),
    },
    "std_msgs/String": {"data": Word("", "the text")},
    "geometry_msgs/Point": _XYZ,
    "geometry_msgs/Point32": _XYZ,
    "geometry_msgs/Vector3": _VECTOR,
    "geometry_msgs/Quaternion": {axis: Word("", f"{axis} of the unit quaternion") for axis in "xyzw"},
    "geometry_msgs/Pose2D": {"x": _XYZ["x"], "y": _XYZ["y"], "theta": Word("rad", "heading, counterclockwise from x")},
    "geometry_msgs/PoseWithCovariance": {"covariance": Word("", "covariance of the pose")},
    "geometry_msgs/TwistWithCovariance": {"covariance": Word("", "covariance of the speeds")},
    "geometry_msgs/Twist": {"linear": Word("m/s", "speed"), "angular": Word("rad/s", "turning speed")},
    "geometry_msgs/Accel": {"linear": Word("m/s2", "acceleration"), "angular": Word("rad/s2", "turning acceleration")},
    "geometry_msgs/Wrench": {"force": Word("N", "force"), "torque": Word("N m", "torque")},
    "geometry_msgs/Transform": {"translation": Word("m", "place of the child frame")},
    "geometry_msgs/TransformStamped": {"child_frame_id": Word("", "frame whose pose this is")},
    "geometry_msgs/PointStamped": {"point": Word("m", "the point")},
    "nav_msgs/Odometry": {
        "child_frame_id": Word("", "frame whose pose this is, and that the speeds are in"),
        "pose": Word("", "pose of the base"),
        "twist": Word("", "speeds of the base"),
    },
    "mavros_msgs/Mavlink": {
        "header": Word("", "its frame_id is the name of the link, in ours"),
        "framing_status": Word("", "1 whole, 2 wrong checksum, 3 wrong signature"),
        "magic": Word("", "first byte: 253 MAVLink 2, 254 MAVLink 1"),
        "len": Word("", "bytes of the payload"),
        "incompat_flags": Word("", "what a receiver has to know, a bit each"),
        "compat_flags": Word("", "what a receiver need not know, a bit each"),
        "seq": Word("", "the sender's count on this link, 0 to 255"),
        "sysid": Word("", "system that sends"),
        "compid": Word("", "component of it that sends"),
        "msgid": Word("", "kind of message"),
        "checksum": Word("", "of the frame"),
        "payload64": Word("", "payload, eight bytes a number, little-endian; zeros after it"),
        "signature": Word("", "of a signed frame, left out in ours"),
    },
    "mavros_msgs/State": {
        "connected": Word("", "its software answers"),
        "armed": Word("", "its motors obey"),
        "guided": Word("", "it goes where it is told"),
        "manual_input": Word("", "it goes as a hand drives it"),
        "mode": Word("", "name of its mode"),
        "system_status": Word("", "code of MAV_STATE"),
    },
    "nav_msgs/MapMetaData": {
        "map_load_time": Word("", "when the map was loaded"),
        "resolution": Word("m", "side of a cell"),
        "width": Word("", "cells in a row"),
        "height": Word("", "rows"),
        "origin": Word("", "pose of the lower left corner of the first cell"),
    },
    "nav_msgs/OccupancyGrid": {
        "data": Word("", "cells by rows from the lower left: 0 free to 100 occupied, -1 unknown"),
    },
    "nav_msgs/Path": {"poses": Word("", "points of the path, from its start")},
    "geometry_msgs/PoseArray": {"poses": Word("", "the poses; of a particle filter, its particles")},
    "sensor_msgs/LaserScan": {
        "angle_min": Word("rad", "angle of the first beam"),
        "angle_max": Word("rad", "angle of the last beam"),
        "angle_increment": Word("rad", "angle from one beam to the next"),
        "time_increment": Word("s", "time from one beam to the next"),
        "scan_time": Word("s", "time from one scan to the next"),
        "range_min": Word("m", "nearest that counts"),
        "range_max": Word("m", "farthest that counts"),
        "ranges": Word("m", "range of each beam; in ours inf: nothing in range, nan: the beam was lost"),
        "intensities": Word("", "intensity of each beam, if the laser has them"),
    },
    "sensor_msgs/Range": {
        "field_of_view": Word("rad", "width of the beam"),
        "min_range": Word("m", "nearest that counts"),
        "max_range": Word("m", "farthest that counts"),
        "range": Word("m", "the range"),
    },
    "sensor_msgs/Imu": {
        "angular_velocity": Word("rad/s", "turning speed"),
        "linear_acceleration": Word("m/s2", "acceleration, gravity among it"),
        "orientation_covariance": Word("rad2", "covariance by rows; -1 first: there is no orientation"),
        "angular_velocity_covariance": Word("rad2/s2", "covariance by rows"),
        "linear_acceleration_covariance": Word("m2/s4", "covariance by rows"),
    },
    "sensor_msgs/JointState": {
        "name": Word("", "names of the joints"),
        "position": Word("", "rad, or m of sliding joints"),
        "velocity": Word("", "rad/s, or m/s of sliding joints"),
        "effort": Word("", "N m, or N of sliding joints"),
    },
    "sensor_msgs/NavSatFix": {
        "latitude": Word("deg", "north of the equator"),
        "longitude": Word("deg", "east of Greenwich"),
        "altitude": Word("m", "above the ellipsoid"),
        "position_covariance": Word("m2", "covariance east, north, up, by rows"),
    },
    "sensor_msgs/MagneticField": {"magnetic_field": Word("T", "magnetic field")},
    "sensor_msgs/Temperature": {"temperature": Word("degC", "temperature"), "variance": Word("", "its variance")},
    "sensor_msgs/FluidPressure": {"fluid_pressure": Word("Pa", "pressure"), "variance": Word("", "its variance")},
    "sensor_msgs/BatteryState": {
        "voltage": Word("V", "voltage"),
        "temperature": Word("degC", "temperature"),
        "current": Word("A", "current, negative while discharging"),
        "charge": Word("", "what is left: Ah; in our hunts the game's energy"),
        "capacity": Word("", "what the last full charge was: Ah; in our hunts the game's energy"),
        "design_capacity": Word("", "capacity when new: Ah; in our hunts the game's energy"),
        "percentage": Word("", "share that is left, 0 to 1"),
        "power_supply_status": Word("", "0 unknown, 1 charging, 2 discharging, 3 not charging, 4 full"),
        "power_supply_health": Word("", "0 unknown, 1 good; others are faults"),
        "power_supply_technology": Word("", "0 unknown, 1 NiMH, 2 Li-ion, 3 Li-polymer, 4 LiFe, 5 NiCd, 6 LiMn"),
        "present": Word("", "whether there is a battery"),
        "cell_voltage": Word("V", "voltage of each cell"),
        "cell_temperature": Word("degC", "temperature of each cell"),
        "location": Word("", "where the battery is; in ours the name of the robot"),
        "serial_number": Word("", "of the battery"),
    },
    "rosgraph_msgs/Log": {
        "level": Word("", "1 debug, 2 info, 4 warning, 8 error, 16 fatal"),
        "name": Word("", "the node"),
        "msg": Word("", "what it says"),
        "file": Word("", "file of the program"),
        "function": Word("", "function there"),
        "line": Word("", "line there"),
        "topics": Word("", "topics that the node publishes"),
    },
    "rosgraph_msgs/Clock": {"clock": Word("", "simulated time")},
    "actionlib_msgs/GoalStatusArray": {"status_list": Word("", "goals of late, and how they stand")},
    "geometry_msgs/PolygonStamped": {"polygon": Word("", "the outline")},
    "geometry_msgs/Polygon": {"points": Word("", "corners")},
    "diagnostic_msgs/DiagnosticArray": {"status": Word("", "states of the parts")},
    "diagnostic_msgs/DiagnosticStatus": {
        "level": Word("", "0 ok, 1 warning, 2 error, 3 stale"),
        "name": Word("", "the part"),
        "message": Word("", "how it is"),
        "hardware_id": Word("", "its hardware"),
        "values": Word("", "what it measured"),
    },
    "diagnostic_msgs/KeyValue": {"key": Word("", "what"), "value": Word("", "how much")},
    "actionlib_msgs/GoalID": {
        "stamp": Word("", "when the goal was set"),
        "id": Word("", "name of the goal"),
    },
    "actionlib_msgs/GoalStatus": {"status": _STATUS, "text": Word("", "why, for people")},
    "move_base_msgs/MoveBaseGoal": {"target_pose": Word("", "pose to reach")},
    "move_base_msgs/MoveBaseFeedback": {"base_position": Word("", "where the robot is")},
    "visualization_msgs/Marker": {
        "ns": Word("", "namespace; in ours the name of the thing"),
        "type": Word("", "shape, by rviz's numbers"),
        "action": Word("", "0 add, 2 delete, 3 delete all"),
        "id": Word("", "number of the marker in its namespace"),
        "pose": Word("", "place of the marker"),
        "color": Word("", "colour, 0 to 1"),
        "lifetime": Word("", "how long it is shown; 0: for ever"),
        "frame_locked": Word("", "whether it moves with its frame"),
        "points": Word("", "corners, in the marker's own place"),
        "colors": Word("", "colour of each point, 0 to 1"),
        "text": Word("", "text of the marker"),
        "mesh_resource": Word("", "its mesh"),
        "mesh_use_embedded_materials": Word("", "whether the mesh brings its colours"),
        "scale": Word("m", "size"),
    },
    **{msgtype: dict(_said(text)) for msgtype, text in OWN_TEXTS.items()},
}

TOPICS: Mapping[str, str] = {
    "/thbridge/session": "what the session was run with",
    "/tf": "frames that move: map to odom by the localiser, odom to base by odometry",
    "/tf_static": "frames that stay",
    "/map": "the map",
    "/map_metadata": "size and place of the map",
    "/sendRobots": "raw %%goto lines, as in the system of 2016",
    "/success": "raw %%error lines, as in the system of 2016",
    "/hunt/events": "every event of the game",
    "/hunt/score": "how the game stands, at each change",
    "/hunt/wizard": "robots that a researcher speaks for, and what waits for that, at each change",
    "/watch/status": "what the watch door told whoever captured this",
    "/things": "outlines of things in the way",
    "/dialogue/utterances": "everything said in a dialogue",
    "/inputs": "every line that people and foreign programs sent",
    "/clock": "simulated time",
    "/rosout": "what nodes log",
    "odom": "odometry: where the wheels say the robot is",
    "base_pose_ground_truth": "where the robot was in truth",
    "scan": "scans of the laser",
    "base_scan": "scans of the laser",
    "amcl_pose": "where the localiser holds the robot to be, at each update",
    "particlecloud": "the localiser's particles, at each update",
    "initialpose": "where people said the robot is",
    "cmd_vel": "speeds that the robot was told to drive",
    "battery": "what is left in the battery",
    "goal": "goals that were set",
    "cancel": "goals that were cancelled",
    "status": "how goals stand",
    "feedback": "how goals come on",
    "result": "how goals ended",
    "plan": "paths of the global planner",
    "local_plan": "paths of the local planner",
    "global_plan": "part of the global path that the local planner follows",
    "costmap": "a costmap",
    "footprint": "the outline of the robot",
}
"""What topics hold, by whole name or by last word."""

_SUFFIXES = {
    "degC": "celsius",
    "N m": "n_m",
}


def unit_of(path: Path) -> str:
    """Unit of the value at the end of a path: what is nearest to it and has one; "" where nobody says."""
    for step in reversed(path):
        if (word := WORDS.get(step.msgtype, {}).get(step.field)) and word.unit:
            return word.unit
    return ""


def meaning_of(path: Path) -> str:
    """What a value means, from the outermost word to the innermost: "speeds of the base: turning speed: about z"."""
    told = (WORDS.get(step.msgtype, {}).get(step.field) for step in path)
    return ": ".join(dict.fromkeys(word.meaning for word in told if word is not None))


def topic_meaning(topic: str) -> str:
    """What a topic holds, "" where nobody knows."""
    return TOPICS.get(topic) or TOPICS.get(topic.rpartition("/")[2], "")


def suffix_of(unit: str) -> str:
    """A unit as the end of a column's name: "m/s2" gives "m_s2"."""
    return _SUFFIXES.get(unit, unit.replace("/", "_").replace(" ", "_").lower())


def axis_units(speeds: bool) -> Sequence[str]:
    """Units of x, y, z, roll, pitch, yaw, or of their speeds."""
    return (*["m/s" if speeds else "m"] * 3, *["rad/s" if speeds else "rad"] * 3)
