"""Conversion of the simulation's values to bytes of ROS 1 messages.

The bytes are written directly in the wire format (roscpp_serialization): fields are in order and little-endian.
Strings and lists begin with a 32-bit length. Ten robots publish 1,900 messages per second, so message objects would be
too slow.

The `seq` of every header is the tick. A gap means that no message was due. Poses are planar: z, roll and pitch are 0.
"""

from thbridge.ros.messages.pack.actions import (
    goal_id,
    goal_status_array,
    move_base_feedback,
    move_base_goal,
    move_base_result,
    recovery_status,
)
from thbridge.ros.messages.pack.fields import (
    POSE_BYTES,
    boolean,
    compiled_pose,
    float64,
    frame_names,
    head,
    header,
    string,
)
from thbridge.ros.messages.pack.game import (
    dialogue_move,
    dialogue_state,
    game_event,
    outside_input,
    score,
    seat_notice,
    session,
    utterance,
)
from thbridge.ros.messages.pack.logs import DiagnosticLevel, DiagnosticStatus, clock, diagnostic_array, log
from thbridge.ros.messages.pack.maps import (
    ADD,
    RoomLabel,
    costmap,
    map_meta_data,
    occupancy_grid,
    outlines,
    room_labels,
)
from thbridge.ros.messages.pack.motion import (
    NO_COVARIANCE,
    OdometryRows,
    Transform,
    command,
    covariance,
    odometry,
    path,
    polygon,
    pose_array,
    pose_stamped,
    pose_with_covariance,
    stamped_transforms,
    transforms,
)
from thbridge.ros.messages.pack.sensing import battery_state, laser_scan
from thbridge.ros.messages.pack.vehicles import mavlink, vehicle_state
