"""Records in bags in addition to the robots' own topics: session, game, dialogue, inputs, requests, vehicles.

Robots are indices in the team, from 0. Rooms are numbers for people, and 0 is the corridor. In messages, robots count
from 1, as in their namespaces.
"""

from dataclasses import dataclass
from enum import IntEnum

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.numerics.float_array import FloatArray
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.session_records import (
    DialogueMoveRecord,
    DialogueStateRecord,
    GameEvent,
    HeldTurns,
    InputRecord,
    ScoreRecord,
    SeatNotice,
    TeamEvent,
    UtteranceRecord,
)


@dataclass(frozen=True, slots=True)
class SendRobots:
    """Unchanged %%goto line for a topic of the 2016 system."""

    line: str


@dataclass(frozen=True, slots=True)
class Success:
    """Unchanged %%error line for a topic of the 2016 system."""

    line: str


@dataclass(frozen=True, slots=True, eq=False)
class InitialPose:
    """Pose estimate that a person gave to a robot (rviz: 2D Pose Estimate).

    Attributes:
        robot: the robot.
        base_in_map: the estimate.
        covariance: (3, 3) of x, y, theta in the map frame.
    """

    robot: int
    base_in_map: Pose2
    covariance: FloatArray


@dataclass(frozen=True, slots=True)
class GoalRequest:
    """Goal that a client set at a robot's action server move_base.

    Attributes:
        robot: the robot.
        goal_id: the client's id of the goal. If empty, the server chooses an id.
        stamp_ns: the client's time stamp, nanoseconds of ROS time. 0 means now.
        base_in_map: goal pose of the base. None if it cannot be used.
        number: its `Goal.id` in the simulation. It is unique among the goals of the owner, here clients of ROS.
        refusal: reason, for people, why the pose cannot be used.
    """

    robot: int
    goal_id: str
    stamp_ns: int
    base_in_map: Pose2 | None
    number: int
    refusal: str = ""


@dataclass(frozen=True, slots=True)
class CancelRequest:
    """Cancel request of a client to a robot's action server move_base.

    Attributes:
        robot: the robot.
        goal_id: id of the goal to cancel. Empty if the request is not for a single goal.
        stamp_ns: all goals up to this time stamp are cancelled, nanoseconds of ROS time. 0 without a goal_id cancels
            all goals.
    """

    robot: int
    goal_id: str
    stamp_ns: int


@dataclass(frozen=True, slots=True)
class SimpleGoal:
    """Goal that a person set on the map (rviz: 2D Nav Goal). For its attributes, see `GoalRequest`."""

    robot: int
    base_in_map: Pose2 | None
    number: int
    refusal: str = ""
    owner: GoalOwner = GoalOwner.ROS_CLIENT


@dataclass(frozen=True, slots=True)
class VelocityCommand:
    """Velocity command of a person or program that drives a robot by hand."""

    robot: int
    twist: Twist


class LogLevel(IntEnum):
    """Severity of a log line, in the codes of rosgraph_msgs/Log."""

    DEBUG = 1
    INFO = 2
    WARN = 4
    ERROR = 8
    FATAL = 16


@dataclass(frozen=True, slots=True)
class LogLine:
    """Line of the common log of all ROS nodes (/rosout).

    Attributes:
        level: severity.
        name: name of the node that writes it, for example "/robot1/move_base".
        text: the message.
    """

    level: LogLevel
    name: str
    text: str


@dataclass(frozen=True, slots=True)
class MavlinkFrame:
    """MAVLink frame with the fields of mavros_msgs/Mavlink, without its signature.

    Attributes:
        link: frame_id of the message's header. In our recordings, it is the name of the link.
        magic: first byte of the frame. It is 254 for MAVLink 1 and 253 for MAVLink 2.
        incompat_flags: flags of MAVLink 2 that a receiver must support.
        compat_flags: flags of MAVLink 2 that a receiver may ignore.
        sequence: the sender's sequence number.
        system: system id of the sender.
        component: component id of the sender.
        message_id: type of the message.
        checksum: checksum in the frame. It is not verified here.
        payload: payload of at most 255 bytes.
    """

    link: str
    magic: int
    incompat_flags: int
    compat_flags: int
    sequence: int
    system: int
    component: int
    message_id: int
    checksum: int
    payload: bytes


@dataclass(frozen=True, slots=True)
class VehicleFrame:
    """MAVLink frame that a robot's vehicle received or sent.

    Attributes:
        robot: the robot.
        received: True if the vehicle received the frame. False if the vehicle sent it.
        frame: the frame.
    """

    robot: int
    received: bool
    frame: MavlinkFrame


@dataclass(frozen=True, slots=True)
class VehicleState:
    """State of a robot as a MAVLink vehicle, with the fields of mavros_msgs/State.

    Attributes:
        robot: the robot.
        connected: True if its heartbeats arrive.
        armed: True if its motors are enabled.
        guided: True if it drives to given goals.
        manual_input: True if a person drives it by hand.
        mode: name of its mode.
        system_status: a code of MAV_STATE.
    """

    robot: int
    connected: bool
    armed: bool
    guided: bool
    manual_input: bool
    mode: str
    system_status: int


GraphRequest = GoalRequest | CancelRequest | SimpleGoal | VelocityCommand | InitialPose
"""Request that was received on a topic of a ROS graph."""

VehicleRecord = VehicleFrame | VehicleState
"""Record that only robots with a MAVLink vehicle have."""

Record = (
    GameEvent
    | ScoreRecord
    | UtteranceRecord
    | DialogueMoveRecord
    | DialogueStateRecord
    | HeldTurns
    | TeamEvent
    | SeatNotice
    | InputRecord
    | SendRobots
    | Success
    | LogLine
    | GraphRequest
    | VehicleRecord
)
