"""Units and meanings of message fields, for ROS's common types and thbridge's types.

Units follow REP 103 and the comments in ROS's definitions. Fields of other types have no unit or meaning.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

from thbridge.analysis.fields.layout import Path
from thbridge.ros.messages.types import OWN_TEXTS


class FieldMeaning(NamedTuple):
    """Unit of all numbers in a field ("" if there is none or several), and meaning of the field."""

    unit: str
    meaning: str


_XYZ = {"x": FieldMeaning("m", "along x"), "y": FieldMeaning("m", "along y"), "z": FieldMeaning("m", "up")}
_VECTOR = {axis: FieldMeaning("", axis) for axis in "xyz"}
_STATUS = FieldMeaning("", "0 pending, 1 active, 2 preempted, 3 succeeded, 4 aborted, 5 rejected, 8 recalled, 9 lost")


def _comments_of(text: str) -> Iterator[tuple[str, FieldMeaning]]:
    """Yield the fields of a definition, with their comments as meanings."""
    for line in text.splitlines():
        declared, _, comment = line.partition("#")
        if words := declared.split():
            yield words[1], FieldMeaning("", comment.strip())


MEANINGS: Mapping[str, Mapping[str, FieldMeaning]] = {
    "std_msgs/Header": {
        "seq": FieldMeaning("", "sequence number of the message, set by the publisher; often 0"),
        "stamp": FieldMeaning("", "time of the values; in thbridge's recordings, simulated time that begins at 1 s"),
        "frame_id": FieldMeaning("", "frame of the values"),
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
    "geometry_msgs/Transform": {"translation": FieldMeaning("m", "position of the child frame")},
    "geometry_msgs/TransformStamped": {"child_frame_id": FieldMeaning("", "frame described by this pose")},
    "geometry_msgs/PointStamped": {"point": FieldMeaning("m", "the point")},
    "nav_msgs/Odometry": {
        "child_frame_id": FieldMeaning("", "frame of this pose and of the speeds"),
        "pose": FieldMeaning("", "pose of the base"),
        "twist": FieldMeaning("", "speeds of the base"),
    },
    "mavros_msgs/Mavlink": {
        "header": FieldMeaning("", "in thbridge's recordings, the header's frame_id is the name of the link"),
        "framing_status": FieldMeaning("", "1 valid, 2 wrong checksum, 3 wrong signature"),
        "magic": FieldMeaning("", "first byte: 253 MAVLink 2, 254 MAVLink 1"),
        "len": FieldMeaning("", "bytes of the payload"),
        "incompat_flags": FieldMeaning("", "flags that a receiver must understand"),
        "compat_flags": FieldMeaning("", "flags that a receiver may ignore"),
        "seq": FieldMeaning("", "sender's sequence number on this link, 0 to 255"),
        "sysid": FieldMeaning("", "id of the sending system"),
        "compid": FieldMeaning("", "id of the sending component"),
        "msgid": FieldMeaning("", "id of the message type"),
        "checksum": FieldMeaning("", "checksum of the frame"),
        "payload64": FieldMeaning("", "payload, eight bytes per number, little-endian, padded with zeros"),
        "signature": FieldMeaning("", "signature of a signed frame; omitted in thbridge's recordings"),
    },
    "mavros_msgs/State": {
        "connected": FieldMeaning("", "true if the vehicle's software responds"),
        "armed": FieldMeaning("", "true if the motors are enabled"),
        "guided": FieldMeaning("", "true if the vehicle drives to commanded goals"),
        "manual_input": FieldMeaning("", "true if the vehicle is driven by hand"),
        "mode": FieldMeaning("", "name of the mode"),
        "system_status": FieldMeaning("", "code of MAV_STATE"),
    },
    "nav_msgs/MapMetaData": {
        "map_load_time": FieldMeaning("", "time at which the map was loaded"),
        "resolution": FieldMeaning("m", "size of a cell"),
        "width": FieldMeaning("", "number of cells in a row"),
        "height": FieldMeaning("", "rows"),
        "origin": FieldMeaning("", "pose of the lower left corner of the first cell"),
    },
    "nav_msgs/OccupancyGrid": {
        "data": FieldMeaning("", "cells by rows from the lower left: 0 (free) to 100 (occupied), -1 is unknown"),
    },
    "nav_msgs/Path": {"poses": FieldMeaning("", "points of the path, from its start")},
    "geometry_msgs/PoseArray": {"poses": FieldMeaning("", "the poses; for a particle filter, its particles")},
    "sensor_msgs/LaserScan": {
        "angle_min": FieldMeaning("rad", "angle of the first beam"),
        "angle_max": FieldMeaning("rad", "angle of the last beam"),
        "angle_increment": FieldMeaning("rad", "angle from one beam to the next"),
        "time_increment": FieldMeaning("s", "time from one beam to the next"),
        "scan_time": FieldMeaning("s", "time from one scan to the next"),
        "range_min": FieldMeaning("m", "least valid range"),
        "range_max": FieldMeaning("m", "greatest valid range"),
        "ranges": FieldMeaning(
            "m", "range of each beam; in thbridge's recordings, inf: nothing in range, nan: the beam was lost"
        ),
        "intensities": FieldMeaning("", "intensity of each beam, if the laser measures it"),
    },
    "sensor_msgs/Range": {
        "field_of_view": FieldMeaning("rad", "width of the beam"),
        "min_range": FieldMeaning("m", "least valid range"),
        "max_range": FieldMeaning("m", "greatest valid range"),
        "range": FieldMeaning("m", "the range"),
    },
    "sensor_msgs/Imu": {
        "angular_velocity": FieldMeaning("rad/s", "turning speed"),
        "linear_acceleration": FieldMeaning("m/s2", "acceleration, including gravity"),
        "orientation_covariance": FieldMeaning(
            "rad2", "covariance by rows; if the first value is -1, there is no orientation"
        ),
        "angular_velocity_covariance": FieldMeaning("rad2/s2", "covariance by rows"),
        "linear_acceleration_covariance": FieldMeaning("m2/s4", "covariance by rows"),
    },
    "sensor_msgs/JointState": {
        "name": FieldMeaning("", "names of the joints"),
        "position": FieldMeaning("", "rad, or m for sliding joints"),
        "velocity": FieldMeaning("", "rad/s, or m/s for sliding joints"),
        "effort": FieldMeaning("", "N m, or N for sliding joints"),
    },
    "sensor_msgs/NavSatFix": {
        "latitude": FieldMeaning("deg", "latitude, positive north of the equator"),
        "longitude": FieldMeaning("deg", "longitude, positive east of Greenwich"),
        "altitude": FieldMeaning("m", "altitude above the ellipsoid"),
        "position_covariance": FieldMeaning("m2", "covariance of east, north, up, by rows"),
    },
    "sensor_msgs/MagneticField": {"magnetic_field": FieldMeaning("T", "magnetic field")},
    "sensor_msgs/Temperature": {
        "temperature": FieldMeaning("degC", "temperature"),
        "variance": FieldMeaning("", "variance"),
    },
    "sensor_msgs/FluidPressure": {
        "fluid_pressure": FieldMeaning("Pa", "pressure"),
        "variance": FieldMeaning("", "variance"),
    },
    "sensor_msgs/BatteryState": {
        "voltage": FieldMeaning("V", "voltage"),
        "temperature": FieldMeaning("degC", "temperature"),
        "current": FieldMeaning("A", "current, negative while discharging"),
        "charge": FieldMeaning("", "charge that is left: Ah; in thbridge's hunts, the game's energy"),
        "capacity": FieldMeaning("", "charge when last full: Ah; in thbridge's hunts, the game's energy"),
        "design_capacity": FieldMeaning("", "capacity when new: Ah; in thbridge's hunts, the game's energy"),
        "percentage": FieldMeaning("", "share that is left, 0 to 1"),
        "power_supply_status": FieldMeaning("", "0 unknown, 1 charging, 2 discharging, 3 not charging, 4 full"),
        "power_supply_health": FieldMeaning("", "0 unknown, 1 good; others are faults"),
        "power_supply_technology": FieldMeaning(
            "", "0 unknown, 1 NiMH, 2 Li-ion, 3 Li-polymer, 4 LiFe, 5 NiCd, 6 LiMn"
        ),
        "present": FieldMeaning("", "true if there is a battery"),
        "cell_voltage": FieldMeaning("V", "voltage of each cell"),
        "cell_temperature": FieldMeaning("degC", "temperature of each cell"),
        "location": FieldMeaning("", "place of the battery; in thbridge's recordings, the name of the robot"),
        "serial_number": FieldMeaning("", "serial number of the battery"),
    },
    "rosgraph_msgs/Log": {
        "level": FieldMeaning("", "1 debug, 2 info, 4 warning, 8 error, 16 fatal"),
        "name": FieldMeaning("", "name of the node"),
        "msg": FieldMeaning("", "text of the message"),
        "file": FieldMeaning("", "source file"),
        "function": FieldMeaning("", "function in the source file"),
        "line": FieldMeaning("", "line in the source file"),
        "topics": FieldMeaning("", "topics that the node publishes"),
    },
    "rosgraph_msgs/Clock": {"clock": FieldMeaning("", "simulated time")},
    "actionlib_msgs/GoalStatusArray": {"status_list": FieldMeaning("", "recent goals, and their states")},
    "geometry_msgs/PolygonStamped": {"polygon": FieldMeaning("", "the outline")},
    "geometry_msgs/Polygon": {"points": FieldMeaning("", "corners")},
    "diagnostic_msgs/DiagnosticArray": {"status": FieldMeaning("", "states of the parts")},
    "diagnostic_msgs/DiagnosticStatus": {
        "level": FieldMeaning("", "0 ok, 1 warning, 2 error, 3 stale"),
        "name": FieldMeaning("", "name of the part"),
        "message": FieldMeaning("", "state of the part in words"),
        "hardware_id": FieldMeaning("", "hardware of the part"),
        "values": FieldMeaning("", "measured values"),
    },
    "std_msgs/ColorRGBA": {
        "r": FieldMeaning("", "red, 0 to 1"),
        "g": FieldMeaning("", "green, 0 to 1"),
        "b": FieldMeaning("", "blue, 0 to 1"),
        "a": FieldMeaning("", "opacity, 0 to 1"),
    },
    "diagnostic_msgs/KeyValue": {"key": FieldMeaning("", "name of the value"), "value": FieldMeaning("", "the value")},
    "actionlib_msgs/GoalID": {
        "stamp": FieldMeaning("", "time at which the goal was set"),
        "id": FieldMeaning("", "name of the goal"),
    },
    "actionlib_msgs/GoalStatus": {"status": _STATUS, "text": FieldMeaning("", "reason, for people")},
    "move_base_msgs/MoveBaseGoal": {"target_pose": FieldMeaning("", "pose to reach")},
    "move_base_msgs/MoveBaseFeedback": {"base_position": FieldMeaning("", "pose of the robot")},
    "visualization_msgs/Marker": {
        "ns": FieldMeaning("", "namespace; in thbridge's recordings, the name of the thing"),
        "type": FieldMeaning("", "shape, by rviz's numbers"),
        "action": FieldMeaning("", "0 add, 2 delete, 3 delete all"),
        "id": FieldMeaning("", "number of the marker in its namespace"),
        "pose": FieldMeaning("", "pose of the marker"),
        "color": FieldMeaning("", "color, 0 to 1"),
        "lifetime": FieldMeaning("", "time for which the marker is shown; 0 means forever"),
        "frame_locked": FieldMeaning("", "true if the marker moves with its frame"),
        "points": FieldMeaning("", "corners, relative to the marker's pose"),
        "colors": FieldMeaning("", "color of each point, 0 to 1"),
        "text": FieldMeaning("", "text of the marker"),
        "mesh_resource": FieldMeaning("", "file of the marker's mesh"),
        "mesh_use_embedded_materials": FieldMeaning("", "true if the mesh contains its colors"),
        "scale": FieldMeaning("m", "size"),
    },
    **{msgtype: dict(_comments_of(text)) for msgtype, text in OWN_TEXTS.items()},
}

TOPICS: Mapping[str, str] = {
    "/thbridge/session": "settings of the session",
    "/tf": "moving frames: map to odom from the localizer, odom to base from odometry",
    "/tf_static": "static frames",
    "/map": "the map",
    "/map_metadata": "size and position of the map",
    "/sendRobots": "raw %%goto lines, as in the system of 2016",
    "/success": "raw %%error lines, as in the system of 2016",
    "/hunt/events": "all events of the game",
    "/hunt/score": "state of the game, at each change",
    "/hunt/wizard": "robots for which a researcher speaks, and waiting sentences, at each change",
    "/hunt/team": "texts and votes of participants, in games with several seats",
    "/hunt/shown": "what each participant was shown, in games with several seats",
    "/watch/status": "status that the watch server sent to the recording client",
    "/things": "outlines of obstacles",
    "/hunt/rooms": "names of rooms, each at its goal",
    "/dialogue/utterances": "all utterances of dialogues",
    "/dialogue/moves": "moves in dialogue games, if robots argue",
    "/dialogue/states": "beliefs and dialogue state of a robot that argues, at each change",
    "/inputs": "all lines that people and other programs sent",
    "/clock": "simulated time",
    "/rosout": "log messages of nodes",
    "odom": "odometry: pose of the robot according to its wheels",
    "base_pose_ground_truth": "true pose of the robot",
    "scan": "scans of the laser",
    "base_scan": "scans of the laser",
    "amcl_pose": "pose estimated by the localizer, at each update",
    "believed_pose": "pose that the robot believed, at each scan",
    "position_error": "distance between the believed and the true pose, at each scan, m",
    "heading_error": "angle from the true to the believed heading, at each scan, rad",
    "lost": "true if the localizer considers itself lost",
    "p_wrong": "probability that the localizer's pose is wrong by more than 1 m or 0.5 rad, at each update",
    "particlecloud": "particles of the localizer, at each update",
    "initialpose": "pose of the robot given by a person",
    "cmd_vel": "commanded speeds",
    "battery": "state of the battery",
    "goal": "goals that were set",
    "cancel": "goals that were canceled",
    "status": "states of goals",
    "feedback": "progress of goals",
    "result": "results of goals",
    "plan": "paths of the global planner",
    "local_plan": "paths of the local planner",
    "global_plan": "part of the global path that the local planner follows",
    "costmap": "a costmap",
    "footprint": "the outline of the robot",
}
"""Contents of topics, by the full name of the topic or by its last word."""

_SUFFIXES = {
    "degC": "celsius",
    "N m": "n_m",
}


def unit_of(path: Path) -> str:
    """Return the unit of the value at the end of a path: the unit of the nearest field with a unit, or ""."""
    for step in reversed(path):
        if (meaning := MEANINGS.get(step.msgtype, {}).get(step.field)) and meaning.unit:
            return meaning.unit
    return ""


def meaning_of(path: Path) -> str:
    """Return the meaning of a value, from the outermost to the innermost field: "speeds of the base: turning speed"."""
    meanings = (MEANINGS.get(step.msgtype, {}).get(step.field) for step in path)
    return ": ".join(dict.fromkeys(meaning.meaning for meaning in meanings if meaning and meaning.meaning))


def topic_meaning(topic: str) -> str:
    """Return the contents of a topic; "" if they are unknown."""
    return TOPICS.get(topic) or TOPICS.get(topic.rpartition("/")[2], "")


def suffix_of(unit: str) -> str:
    """Return a unit as the suffix of a column's name: "m/s2" gives "m_s2"."""
    return _SUFFIXES.get(unit, unit.replace("/", "_").replace(" ", "_").lower())


def axis_units(speeds: bool) -> Sequence[str]:
    """Return the units of x, y, z, roll, pitch, yaw, or of their speeds."""
    return (*["m/s" if speeds else "m"] * 3, *["rad/s" if speeds else "rad"] * 3)
