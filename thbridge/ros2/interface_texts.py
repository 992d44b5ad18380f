"""Definitions of ROS 2 types that the library rosbags lacks, without comments, and default values that it omits.

Each text has the fields and constants of the .msg, .srv or .action file of the same name. Sources: ros2/rcl_interfaces,
ros2/common_interfaces, ros-navigation/navigation2, mavlink/mavros.

Jazzy and Kilted have different definitions of these types:

* nav2_msgs/action/NavigateToPose: Kilted has more error codes. The fields are the same, so the hash is the same.
* nav2_msgs/action/FollowWaypoints: Kilted has more error codes, and reports missed waypoints as WaypointStatus.
* nav2_msgs/srv/IsPathValid: Kilted has a maximum cost, and an option for unknown space.
* nav2_msgs/msg/MissedWaypoint, nav2_msgs/srv/GetCost and nav2_msgs/srv/ClearCostmapAroundPose exist only in Jazzy.
* nav2_msgs/msg/WaypointStatus, nav_msgs/msg/Goals and nav2_msgs/srv/GetCosts exist only in Kilted.

All other types are the same in both.
"""

from collections.abc import Mapping

from thbridge.ros.messages.definition_texts import ROS_TEXTS
from thbridge.ros.messages.types import OWN_TEXTS

_COMMON = {
    "rcl_interfaces/srv/DescribeParameters": "string[] names\n---\nParameterDescriptor[] descriptors",
    "rcl_interfaces/srv/GetLoggerLevels": "string[] names\n---\nLoggerLevel[] levels",
    "rcl_interfaces/srv/GetParameterTypes": "string[] names\n---\nuint8[] types",
    "rcl_interfaces/srv/GetParameters": "string[] names\n---\nParameterValue[] values",
    "rcl_interfaces/srv/ListParameters": "uint64 DEPTH_RECURSIVE=0\nstring[] prefixes\nuint64 depth\n---\n"
    "ListParametersResult result",
    "rcl_interfaces/srv/SetLoggerLevels": "LoggerLevel[] levels\n---\nSetLoggerLevelsResult[] results",
    "rcl_interfaces/srv/SetParameters": "Parameter[] parameters\n---\nSetParametersResult[] results",
    "rcl_interfaces/srv/SetParametersAtomically": "Parameter[] parameters\n---\nSetParametersResult result",
    "type_description_interfaces/srv/GetTypeDescription": """\
string type_name
string type_hash
bool include_type_sources true
---
bool successful
string failure_reason
TypeDescription type_description
TypeSource[] type_sources
KeyValue[] extra_information
""",
    "action_msgs/srv/CancelGoal": """\
GoalInfo goal_info
---
int8 ERROR_NONE=0
int8 ERROR_REJECTED=1
int8 ERROR_UNKNOWN_GOAL_ID=2
int8 ERROR_GOAL_TERMINATED=3
int8 return_code
GoalInfo[] goals_canceling
""",
    "lifecycle_msgs/srv/ChangeState": "Transition transition\n---\nbool success",
    "lifecycle_msgs/srv/GetAvailableStates": "---\nState[] available_states",
    "lifecycle_msgs/srv/GetAvailableTransitions": "---\nTransitionDescription[] available_transitions",
    "lifecycle_msgs/srv/GetState": "---\nState current_state",
    "std_srvs/srv/Empty": "---",
    "std_srvs/srv/SetBool": "bool data\n---\nbool success\nstring message",
    "std_srvs/srv/Trigger": "---\nbool success\nstring message",
    "nav_msgs/srv/GetMap": "---\nOccupancyGrid map",
    "tf2_msgs/msg/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "nav2_msgs/msg/Particle": "geometry_msgs/Pose pose\nfloat64 weight",
    "nav2_msgs/msg/ParticleCloud": "std_msgs/Header header\nParticle[] particles",
    "nav2_msgs/msg/CostmapMetaData": """\
builtin_interfaces/Time map_load_time
builtin_interfaces/Time update_time
string layer
float32 resolution
uint32 size_x
uint32 size_y
geometry_msgs/Pose origin
""",
    "nav2_msgs/msg/Costmap": "std_msgs/Header header\nCostmapMetaData metadata\nuint8[] data",
    "nav2_msgs/srv/ClearCostmapAroundRobot": "float32 reset_distance\n---\nstd_msgs/Empty response",
    "nav2_msgs/srv/ClearCostmapExceptRegion": "float32 reset_distance\n---\nstd_msgs/Empty response",
    "nav2_msgs/srv/ClearEntireCostmap": "std_msgs/Empty request\n---\nstd_msgs/Empty response",
    "nav2_msgs/srv/GetCostmap": "CostmapMetaData specs\n---\nCostmap map",
    "nav2_msgs/srv/LoadMap": """\
string map_url
---
uint8 RESULT_SUCCESS=0
uint8 RESULT_MAP_DOES_NOT_EXIST=1
uint8 RESULT_INVALID_MAP_DATA=2
uint8 RESULT_INVALID_MAP_METADATA=3
uint8 RESULT_UNDEFINED_FAILURE=255
nav_msgs/OccupancyGrid map
uint8 result
""",
    "nav2_msgs/srv/ManageLifecycleNodes": """\
uint8 STARTUP=0
uint8 PAUSE=1
uint8 RESUME=2
uint8 RESET=3
uint8 SHUTDOWN=4
uint8 CONFIGURE=5
uint8 CLEANUP=6
uint8 command
---
bool success
""",
    "nav2_msgs/srv/SetInitialPose": "geometry_msgs/PoseWithCovarianceStamped pose\n---",
    "nav2_msgs/action/ComputePathToPose": """\
geometry_msgs/PoseStamped goal
geometry_msgs/PoseStamped start
string planner_id
bool use_start
---
uint16 NONE=0
uint16 UNKNOWN=200
uint16 INVALID_PLANNER=201
uint16 TF_ERROR=202
uint16 START_OUTSIDE_MAP=203
uint16 GOAL_OUTSIDE_MAP=204
uint16 START_OCCUPIED=205
uint16 GOAL_OCCUPIED=206
uint16 TIMEOUT=207
uint16 NO_VALID_PATH=208
nav_msgs/Path path
builtin_interfaces/Duration planning_time
uint16 error_code
string error_msg
---
""",
    "mavros_msgs/msg/Mavlink": ROS_TEXTS["mavros_msgs/Mavlink"]
    .replace("uint64[] payload64", "uint64[<=33] payload64")
    .replace("uint8[] signature", "uint8[<=13] signature"),
    "mavros_msgs/msg/State": ROS_TEXTS["mavros_msgs/State"],
    **{name.replace("/", "/msg/"): text for name, text in OWN_TEXTS.items()},
}

_NAVIGATION_FEEDBACK = """\
geometry_msgs/PoseStamped current_pose
builtin_interfaces/Duration navigation_time
builtin_interfaces/Duration estimated_time_remaining
int16 number_of_recoveries
float32 distance_remaining
"""

_JAZZY = {
    "nav2_msgs/msg/MissedWaypoint": "uint32 index\ngeometry_msgs/PoseStamped goal\nuint16 error_code",
    "nav2_msgs/srv/ClearCostmapAroundPose": """\
geometry_msgs/PoseStamped pose
float64 reset_distance
---
std_msgs/Empty response
""",
    "nav2_msgs/srv/GetCost": "bool use_footprint\nfloat32 x\nfloat32 y\nfloat32 theta\n---\nfloat32 cost",
    "nav2_msgs/srv/IsPathValid": "nav_msgs/Path path\n---\nbool is_valid\nint32[] invalid_pose_indices",
    "nav2_msgs/action/NavigateToPose": f"""\
geometry_msgs/PoseStamped pose
string behavior_tree
---
uint16 NONE=0
uint16 error_code
string error_msg
---
{_NAVIGATION_FEEDBACK}""",
    "nav2_msgs/action/FollowWaypoints": """\
uint32 number_of_loops
uint32 goal_index 0
geometry_msgs/PoseStamped[] poses
---
uint16 NONE=0
uint16 UNKNOWN=600
uint16 TASK_EXECUTOR_FAILED=601
MissedWaypoint[] missed_waypoints
uint16 error_code
string error_msg
---
uint32 current_waypoint
""",
}

_KILTED = {
    "nav2_msgs/msg/WaypointStatus": """\
uint8 PENDING=0
uint8 COMPLETED=1
uint8 SKIPPED=2
uint8 FAILED=3
uint8 waypoint_status
uint32 waypoint_index
geometry_msgs/PoseStamped waypoint_pose
uint16 error_code
string error_msg
""",
    "nav2_msgs/srv/GetCosts": """\
bool use_footprint
geometry_msgs/PoseStamped[] poses
---
float32[] costs
bool success
""",
    "nav2_msgs/srv/IsPathValid": """\
nav_msgs/Path path
uint8 max_cost 254
bool consider_unknown_as_obstacle false
---
bool is_valid
int32[] invalid_pose_indices
""",
    "nav2_msgs/action/NavigateToPose": f"""\
geometry_msgs/PoseStamped pose
string behavior_tree
---
uint16 NONE=0
uint16 UNKNOWN=9000
uint16 FAILED_TO_LOAD_BEHAVIOR_TREE=9001
uint16 TF_ERROR=9002
uint16 TIMEOUT=9003
uint16 error_code
string error_msg
---
{_NAVIGATION_FEEDBACK}""",
    "nav2_msgs/action/FollowWaypoints": """\
uint32 number_of_loops
uint32 goal_index 0
geometry_msgs/PoseStamped[] poses
---
uint16 NONE=0
uint16 UNKNOWN=600
uint16 TASK_EXECUTOR_FAILED=601
uint16 NO_VALID_WAYPOINTS=602
uint16 STOP_ON_MISSED_WAYPOINT=603
WaypointStatus[] missed_waypoints
uint16 error_code
string error_msg
---
uint32 current_waypoint
""",
}

DEFAULTS: Mapping[str, Mapping[str, bool | int | float]] = {
    "geometry_msgs/msg/Quaternion": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0},
    "rcl_interfaces/msg/ParameterDescriptor": {"read_only": False, "dynamic_typing": False},
    "sensor_msgs/msg/NavSatStatus": {"status": -2},
    "type_description_interfaces/msg/FieldType": {"type_id": 0},
}
"""Default values of fields of rosbags' types."""
JAZZY_TEXTS = {**_COMMON, **_JAZZY}
"""Definitions of Jazzy, by name."""
KILTED_TEXTS = {**_COMMON, **_KILTED}
"""Definitions of Kilted, by name."""
