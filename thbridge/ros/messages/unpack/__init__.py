"""Conversion of bytes of ROS 1 messages to values, for reports, replays and real robots. Any program may write bags.

Poses are reduced to the plane: x, y, yaw. Every function raises ValueError if the bytes are not a message of its type.
"""

from thbridge.ros.messages.unpack.actions import (
    MoveBaseGoal,
    MoveBaseResult,
    goal_id,
    goal_result,
    goal_status_array,
    move_base_feedback,
    move_base_goal,
    move_base_result,
)
from thbridge.ros.messages.unpack.game import (
    dialogue_move,
    dialogue_state,
    game_event,
    outside_input,
    score,
    seat_notice,
    utterance,
)
from thbridge.ros.messages.unpack.logs import diagnostic_array, log, string
from thbridge.ros.messages.unpack.robots import (
    BatteryCharge,
    LaserScan,
    OdometryMessage,
    PoseInFrame,
    SpatialTransform,
    battery_state,
    frame_of,
    laser_scan,
    occupancy_grid,
    odometry,
    outlines,
    path,
    polygon,
    pose_array,
    pose_stamped,
    pose_with_covariance,
    room_labels,
    spatial_transforms,
    transform_pieces,
    transforms,
    twist,
)
from thbridge.ros.messages.unpack.vehicles import mavlink
from thbridge.ros.messages.unpack_session import session
