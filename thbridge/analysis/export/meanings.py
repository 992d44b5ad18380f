"""Units and meanings of message fields, for ROS's common types and for ours.

Units are those of REP 103 and of the comments in ROS's definitions. Fields of other types have no unit and no meaning.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from thbridge.analysis.fields.layout import Path
from thbridge.ros.messages.types import OWN_TEXTS


class FieldMeaning(NamedTuple):
    """Unit of all numbers in a field ("" where it has none or several), and meaning of the field."""

    unit: str
    meaning: str


_XYZ = {"x": FieldMeaning("m", "along x"), "y": FieldMeaning("m", "along y"), "z": FieldMeaning("m", "up")}
_VECTOR = {axis: FieldMeaning("", axis) for axis in "xyz"}
_STATUS = FieldMeaning("", "0 pending, 1 active, 2 preempted, 3 succeeded, 4 aborted, 5 rejected, 8 recalled, 9 lost")


def _comments_of(text: str) -> Iterator[tuple[str, FieldMeaning]]:
    """Yield the fields of a definition with their comments as meanings."""
    for line in text.splitlines():
        declared, _, comment = line.partition("#")
        if words := declared.split():
            yield words[1], FieldMeaning("", comment.strip())


MEANINGS: Mapping[str, Mapping[str, FieldMeaning]] = {
    "std_msgs/Header": {
        "seq": FieldMeaning("", "number of the message, from its publisher; often 0"),
        "stamp": FieldMeaning("", "time that the values are of; in ours, simulated time that begins at 1 s"),
        "frame_id": FieldMeaning("", "frame that the values are in"),
    },
    "std_msgs/String": {"data": FieldMeaning("", "the text")},
    "std_msgs/Float64": {"data": FieldMeaning("", "the number")},
    "std_msgs/Bool": {"data": FieldMeaning("", "true or false")},
    "geometry_msgs/Point": _XYZ,
    "geometry_msgs/Point32": _XYZ,
    "geometry_msgs/Vector3": _VECTOR,
    "geometry_msgs/Quaternion": {axis: FieldMeaning("", f"{axis} of the unit quaternion") for axis in "xyzw"},
    "geometry_msgs/Pose2D": {
        "x": _XYZ["x"],
        "y": _XYZ["y"],
        "theta": FieldMeaning("rad", "heading, counterclockwise from x"),
    },
    "geometry_msgs/PoseWithCovariance": {"covariance": FieldMeaning("", "covariance of the pose")},
    "geometry_msgs/TwistWithCovariance": {"covariance": FieldMeaning("", "covariance of the speeds")},
    "geometry_msgs/Twist": {"linear": FieldMeaning("m/s", "speed"), "angular": FieldMeaning("rad/s", "turning speed")},
    "geometry_msgs/Accel": {
        "linear": FieldMeaning("m/s2", "acceleration"),
        "angular": FieldMeaning("rad/s2", "turning acceleration"),
    },
    "geometry_msgs/Wrench": {"force": FieldMeaning("N", "force"), "torque": FieldMeaning("N m", "torque")},
    "geometry_msgs/Transform": {"translation": FieldMeaning("m", "place of the child frame")},
    "geometry_msgs/TransformStamped": {"child_frame_id": FieldMeaning("", "frame whose pose this is")},
    "geometry_msgs/PointStamped": {"point": FieldMeaning("m", "the point")},
    "nav_msgs/Odometry": {
        "child_frame_id": FieldMeaning("", "frame whose pose this is, and that the speeds are in"),
        "pose": FieldMeaning("", "pose of the base"),
        "twist": FieldMeaning("", "speeds of the base"),
    },
    "mavros_msgs/Mavlink": {
        "header": FieldMeaning("", "its frame_id is the name of the link, in ours"),
        "framing_status": FieldMeaning("", "1 whole, 2 wrong checksum, 3 wrong signature"),
        "magic": FieldMeaning("", "first byte: 253 MAVLink 2, 254 MAVLink 1"),
        "len": FieldMeaning("", "bytes of the payload"),
        "incompat_flags": FieldMeaning("", "what a receiver has to know, a bit each"),
        "compat_flags": FieldMeaning("", "what a receiver need not know, a bit each"),
        "seq": FieldMeaning("", "the sender's count on this link, 0 to 255"),
        "sysid": FieldMeaning("", "system that sends"),
        "compid": FieldMeaning("", "component of it that sends"),
        "msgid": FieldMeaning("", "kind of message"),
        "checksum": FieldMeaning("", "of the frame"),
        "payload64": FieldMeaning("", "payload, eight bytes a number, little-endian; zeros after it"),
        "signature": FieldMeaning("", "of a signed frame, left out in ours"),
    },
    "mavros_msgs/State": {
        "connected": FieldMeaning("", "its software answers"),
        "armed": FieldMeaning("", "its motors obey"),
        "guided": FieldMeaning("", "it goes where it is told"),
        "manual_input": FieldMeaning("", "it goes as a hand drives it"),
        "mode": FieldMeaning("", "name of its mode"),
        "system_status": FieldMeaning("", "code of MAV_STATE"),
    },
    "nav_msgs/MapMetaData": {
        "map_load_time": FieldMeaning("", "when the map was loaded"),
        "resolution": FieldMeaning("m", "side of a cell"),
        "width": FieldMeaning("", "cells in a row"),
        "height": FieldMeaning("", "rows"),
        "origin": FieldMeaning("", "pose of the lower left corner of the first cell"),
    },
    "nav_msgs/OccupancyGrid": {
        "data": FieldMeaning("", "cells by rows from the lower left: 0 free to 100 occupied, -1 unknown"),
    },
    "nav_msgs/Path": {"poses": FieldMeaning("", "points of the path, from its start")},
    "geometry_msgs/PoseArray": {"poses": FieldMeaning("", "the poses; of a particle filter, its particles")},
    "sensor_msgs/LaserScan": {
        "angle_min": FieldMeaning("rad", "angle of the first beam"),
        "angle_max": FieldMeaning("rad", "angle of the last beam"),
        "angle_increment": FieldMeaning("rad", "angle from one beam to the next"),
        "time_increment": FieldMeaning("s", "time from one beam to the next"),
        "scan_time": FieldMeaning("s", "time from one scan to the next"),
        "range_min": FieldMeaning("m", "nearest that counts"),
        "range_max": FieldMeaning("m", "farthest that counts"),
        "ranges": FieldMeaning("m", "range of each beam; in ours inf: nothing in range, nan: the beam was lost"),
        "intensities": FieldMeaning("", "intensity of each beam, if the laser has them"),
    },
    "sensor_msgs/Range": {
        "field_of_view": FieldMeaning("rad", "width of the beam"),
        "min_range": FieldMeaning("m", "nearest that counts"),
        "max_range": FieldMeaning("m", "farthest that counts"),
        "range": FieldMeaning("m", "the range"),
    },
    "sensor_msgs/Imu": {
        "angular_velocity": FieldMeaning("rad/s", "turning speed"),
        "linear_acceleration": FieldMeaning("m/s2", "acceleration, gravity among it"),
        "orientation_covariance": FieldMeaning("rad2", "covariance by rows; -1 first: there is no orientation"),
        "angular_velocity_covariance": FieldMeaning("rad2/s2", "covariance by rows"),
        "linear_acceleration_covariance": FieldMeaning("m2/s4", "covariance by rows"),
    },
    "sensor_msgs/JointState": {
        "name": FieldMeaning("", "names of the joints"),
        "position": FieldMeaning("", "rad, or m of sliding joints"),
        "velocity": FieldMeaning("", "rad/s, or m/s of sliding joints"),
        "effort": FieldMeaning("", "N m, or N of sliding joints"),
    },
    "sensor_msgs/NavSatFix": {
        "latitude": FieldMeaning("deg", "north of the equator"),
        "longitude": FieldMeaning("deg", "east of Greenwich"),
        "altitude": FieldMeaning("m", "above the ellipsoid"),
        "position_covariance": FieldMeaning("m2", "covariance east, north, up, by rows"),
    },
    "sensor_msgs/MagneticField": {"magnetic_field": FieldMeaning("T", "magnetic field")},
    "sensor_msgs/Temperature": {
        "temperature": FieldMeaning("degC", "temperature"),
        "variance": FieldMeaning("", "its variance"),
    },
    "sensor_msgs/FluidPressure": {
        "fluid_pressure": FieldMeaning("Pa", "pressure"),
        "variance": FieldMeaning("", "its variance"),
    },
    "sensor_msgs/BatteryState": {
        "voltage": FieldMeaning("V", "voltage"),
        "temperature": FieldMeaning("degC", "temperature"),
        "current": FieldMeaning("A", "current, negative while discharging"),
        "charge": FieldMeaning("", "what is left: Ah; in our hunts the game's energy"),
        "capacity": FieldMeaning("", "what the last full charge was: Ah; in our hunts the game's energy"),
        "design_capacity": FieldMeaning("", "capacity when new: Ah; in our hunts the game's energy"),
        "percentage": FieldMeaning("", "share that is left, 0 to 1"),
        "power_supply_status": FieldMeaning("", "0 unknown, 1 charging, 2 discharging, 3 not charging, 4 full"),
        "power_supply_health": FieldMeaning("", "0 unknown, 1 good; others are faults"),
        "power_supply_technology": FieldMeaning(
            "", "0 unknown, 1 NiMH, 2 Li-ion, 3 Li-polymer, 4 LiFe, 5 NiCd, 6 LiMn"
        ),
        "present": FieldMeaning("", "whether there is a battery"),
        "cell_voltage": FieldMeaning("V", "voltage of each cell"),
        "cell_temperature": FieldMeaning("degC", "temperature of each cell"),
        "location": FieldMeaning("", "where the battery is; in ours the name of the robot"),
        "serial_number": FieldMeaning("", "of the battery"),
    },
    "rosgraph_msgs/Log": {
        "level": FieldMeaning("", "1 debug, 2 info, 4 warning, 8 error, 16 fatal"),
        "name": FieldMeaning("", "the node"),
        "msg": FieldMeaning("", "what it says"),
        "file": FieldMeaning("", "file of the program"),
        "function": FieldMeaning("", "function there"),
        "line": FieldMeaning("", "line there"),
        "topics": FieldMeaning("", "topics that the node publishes"),
    },
    "rosgraph_msgs/Clock": {"clock": FieldMeaning("", "simulated time")},
    "actionlib_msgs/GoalStatusArray": {"status_list": FieldMeaning("", "goals of late, and how they stand")},
    "geometry_msgs/PolygonStamped": {"polygon": FieldMeaning("", "the outline")},
    "geometry_msgs/Polygon": {"points": FieldMeaning("", "corners")},
    "diagnostic_msgs/DiagnosticArray": {"status": FieldMeaning("", "states of the parts")},
    "diagnostic_msgs/DiagnosticStatus": {
        "level": FieldMeaning("", "0 ok, 1 warning, 2 error, 3 stale"),
        "name": FieldMeaning("", "the part"),
        "message": FieldMeaning("", "how it is"),
        "hardware_id": FieldMeaning("", "its hardware"),
        "values": FieldMeaning("", "what it measured"),
    },
    "std_msgs/ColorRGBA": {
        "r": FieldMeaning("", "red, 0 to 1"),
        "g": FieldMeaning("", "green, 0 to 1"),
        "b": FieldMeaning("", "blue, 0 to 1"),
        "a": FieldMeaning("", "opacity, 0 to 1"),
    },
    "diagnostic_msgs/KeyValue": {"key": FieldMeaning("", "what"), "value": FieldMeaning("", "how much")},
    "actionlib_msgs/GoalID": {
        "stamp": FieldMeaning("", "when the goal was set"),
        "id": FieldMeaning("", "name of the goal"),
    },
    "actionlib_msgs/GoalStatus": {"status": _STATUS, "text": FieldMeaning("", "why, for people")},
    "move_base_msgs/MoveBaseGoal": {"target_pose": FieldMeaning("", "pose to reach")},
    "move_base_msgs/MoveBaseFeedback": {"base_position": FieldMeaning("", "where the robot is")},
    "visualization_msgs/Marker": {
        "ns": FieldMeaning("", "namespace; in ours the name of the thing"),
        "type": FieldMeaning("", "shape, by rviz's numbers"),
        "action": FieldMeaning("", "0 add, 2 delete, 3 delete all"),
        "id": FieldMeaning("", "number of the marker in its namespace"),
        "pose": FieldMeaning("", "place of the marker"),
        "color": FieldMeaning("", "colour, 0 to 1"),
        "lifetime": FieldMeaning("", "how long it is shown; 0: for ever"),
        "frame_locked": FieldMeaning("", "whether it moves with its frame"),
        "points": FieldMeaning("", "corners, in the marker's own place"),
        "colors": FieldMeaning("", "colour of each point, 0 to 1"),
        "text": FieldMeaning("", "text of the marker"),
        "mesh_resource": FieldMeaning("", "its mesh"),
        "mesh_use_embedded_materials": FieldMeaning("", "whether the mesh brings its colours"),
        "scale": FieldMeaning("m", "size"),
    },
    **{msgtype: dict(_comments_of(text)) for msgtype, text in OWN_TEXTS.items()},
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
    "/hunt/rooms": "the names of rooms, each where robots go in it",
    "/dialogue/utterances": "everything said in a dialogue",
    "/dialogue/moves": "moves in dialogue games, where robots argue",
    "/dialogue/states": "what a robot that argues believes and makes of it, at each change",
    "/inputs": "every line that people and foreign programs sent",
    "/clock": "simulated time",
    "/rosout": "what nodes log",
    "odom": "odometry: where the wheels say the robot is",
    "base_pose_ground_truth": "where the robot was in truth",
    "scan": "scans of the laser",
    "base_scan": "scans of the laser",
    "amcl_pose": "where the localiser holds the robot to be, at each update",
    "believed_pose": "where the robot believed to be, at each scan",
    "position_error": "distance of the believed from the true pose, at each scan, m",
    "heading_error": "angle from the true to the believed heading, at each scan, rad",
    "lost": "whether the localiser holds itself to be lost",
    "p_wrong": "probability that the localizer's pose is more than 1 m or 0.5 rad off, at each update",
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
"""Contents of topics, by whole name or by last word."""

_SUFFIXES = {
    "degC": "celsius",
    "N m": "n_m",
}


def unit_of(path: Path) -> str:
    """Unit of the value at the end of a path: that of the nearest field with a unit; "" without one."""
    for step in reversed(path):
        if (meaning := MEANINGS.get(step.msgtype, {}).get(step.field)) and meaning.unit:
            return meaning.unit
    return ""


def meaning_of(path: Path) -> str:
    """Meaning of a value, from the outermost field to the innermost: "speeds of the base: turning speed: about z"."""
    meanings = (MEANINGS.get(step.msgtype, {}).get(step.field) for step in path)
    return ": ".join(dict.fromkeys(meaning.meaning for meaning in meanings if meaning and meaning.meaning))


def topic_meaning(topic: str) -> str:
    """Contents of a topic; "" where they are unknown."""
    return TOPICS.get(topic) or TOPICS.get(topic.rpartition("/")[2], "")


def suffix_of(unit: str) -> str:
    """A unit as suffix of a column's name: "m/s2" gives "m_s2"."""
    return _SUFFIXES.get(unit, unit.replace("/", "_").replace(" ", "_").lower())


def axis_units(speeds: bool) -> Sequence[str]:
    """Units of x, y, z, roll, pitch, yaw, or of their speeds."""
    return (*["m/s" if speeds else "m"] * 3, *["rad/s" if speeds else "rad"] * 3)
