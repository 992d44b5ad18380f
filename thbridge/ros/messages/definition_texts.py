"""Definitions of ROS types that the library rosbags lacks, as in ROS's .msg and .srv files, without comments."""

_MAVROS_MODES = {
    "APM_PLANE": "MANUAL CIRCLE STABILIZE TRAINING ACRO FBWA FBWB CRUISE AUTOTUNE AUTO RTL LOITER LAND GUIDED "
    "INITIALISING QSTABILIZE QHOVER QLOITER QLAND QRTL",
    "APM_COPTER": "STABILIZE ACRO ALT_HOLD AUTO GUIDED LOITER RTL CIRCLE POSITION LAND OF_LOITER DRIFT SPORT FLIP "
    "AUTOTUNE POSHOLD BRAKE THROW AVOID_ADSB GUIDED_NOGPS",
    "APM_ROVER": "MANUAL LEARNING STEERING HOLD AUTO RTL GUIDED INITIALISING",
    "PX4": "MANUAL ACRO ALTITUDE=ALTCTL POSITION=POSCTL OFFBOARD STABILIZED RATTITUDE MISSION=AUTO.MISSION "
    "LOITER=AUTO.LOITER RTL=AUTO.RTL LAND=AUTO.LAND RTGS=AUTO.RTGS READY=AUTO.READY TAKEOFF=AUTO.TAKEOFF",
}
"""The flight modes that mavros_msgs/State names, by kind of vehicle. Constants count in the md5 sum of a type.

A word is NAME=VALUE where the value differs from the name."""


def _mode_constants() -> str:
    return "\n".join(
        f"string MODE_{vehicle}_{mode if '=' in mode else f'{mode}={mode}'}"
        for vehicle, modes in _MAVROS_MODES.items()
        for mode in modes.split()
    )


ROS_TEXTS = {
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "move_base_msgs/MoveBaseGoal": "geometry_msgs/PoseStamped target_pose",
    "move_base_msgs/MoveBaseFeedback": "geometry_msgs/PoseStamped base_position",
    "move_base_msgs/MoveBaseResult": "",
    "move_base_msgs/MoveBaseActionGoal": "std_msgs/Header header\nactionlib_msgs/GoalID goal_id\n"
    "move_base_msgs/MoveBaseGoal goal",
    "move_base_msgs/MoveBaseActionFeedback": "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n"
    "move_base_msgs/MoveBaseFeedback feedback",
    "move_base_msgs/MoveBaseActionResult": "std_msgs/Header header\nactionlib_msgs/GoalStatus status\n"
    "move_base_msgs/MoveBaseResult result",
    "dynamic_reconfigure/BoolParameter": "string name\nbool value",
    "dynamic_reconfigure/IntParameter": "string name\nint32 value",
    "dynamic_reconfigure/StrParameter": "string name\nstring value",
    "dynamic_reconfigure/DoubleParameter": "string name\nfloat64 value",
    "dynamic_reconfigure/GroupState": "string name\nbool state\nint32 id\nint32 parent",
    "dynamic_reconfigure/Config": "BoolParameter[] bools\nIntParameter[] ints\nStrParameter[] strs\n"
    "DoubleParameter[] doubles\nGroupState[] groups",
    "dynamic_reconfigure/ParamDescription": "string name\nstring type\nuint32 level\nstring description\n"
    "string edit_method",
    "dynamic_reconfigure/Group": "string name\nstring type\nParamDescription[] parameters\nint32 parent\nint32 id",
    "dynamic_reconfigure/ConfigDescription": "Group[] groups\nConfig max\nConfig min\nConfig dflt",
    "mavros_msgs/Mavlink": """\
uint8 FRAMING_OK=1
uint8 FRAMING_BAD_CRC=2
uint8 FRAMING_BAD_SIGNATURE=3
uint8 MAVLINK_V10=254
uint8 MAVLINK_V20=253
std_msgs/Header header
uint8 framing_status
uint8 magic
uint8 len
uint8 incompat_flags
uint8 compat_flags
uint8 seq
uint8 sysid
uint8 compid
uint32 msgid
uint16 checksum
uint64[] payload64
uint8[] signature
""",
    "mavros_msgs/State": f"""\
{_mode_constants()}
std_msgs/Header header
bool connected
bool armed
bool guided
bool manual_input
string mode
uint8 system_status
""",
    "std_srvs/EmptyRequest": "",
    "std_srvs/EmptyResponse": "",
    "nav_msgs/GetMapRequest": "",
    "nav_msgs/GetMapResponse": "OccupancyGrid map",
    "nav_msgs/SetMapRequest": "OccupancyGrid map\ngeometry_msgs/PoseWithCovarianceStamped initial_pose",
    "nav_msgs/SetMapResponse": "bool success",
    "nav_msgs/GetPlanRequest": "geometry_msgs/PoseStamped start\ngeometry_msgs/PoseStamped goal\nfloat32 tolerance",
    "nav_msgs/GetPlanResponse": "Path plan",
    "dynamic_reconfigure/ReconfigureRequest": "Config config",
    "dynamic_reconfigure/ReconfigureResponse": "Config config",
    "robot_localization/SetPoseRequest": "geometry_msgs/PoseWithCovarianceStamped pose",
    "robot_localization/SetPoseResponse": "",
}
"""ROS types that rosbags lacks, by name; request and response of a service are types like others."""
