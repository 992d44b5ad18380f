"""Topics of a session, with their message types."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

from sim.parameters import RobotParameters
from thbridge.ros import names
from thbridge.ros.messages import types
from thbridge.ros.names import RobotNames


class Topic(NamedTuple):
    """Topic with its message type. A late subscriber of a latched topic gets the last message."""

    name: str
    msgtype: str
    latched: bool = False


class RosMessage(NamedTuple):
    """Message on a topic.

    Attributes:
        topic: its topic.
        stamp_ns: time of publication, nanoseconds of ROS time.
        data: its bytes.
        foreign: True if another node of the ROS graph has published it. It is recorded, but not published again.
    """

    topic: Topic
    stamp_ns: int
    data: bytes
    foreign: bool = False


MessageFilter: TypeAlias = Callable[[Iterable[RosMessage]], list[RosMessage]]
"""Filter of the messages for a recording. It gets all messages in the order of time."""

CLOCK = Topic(names.CLOCK, types.CLOCK)
"""Clock, which is only published on graphs, because `rosbag play` publishes its own clock."""
TF = Topic(names.TF, types.TFMESSAGE)
TF_STATIC = Topic(names.TF_STATIC, types.TFMESSAGE, latched=True)
MAP = Topic(names.MAP, types.OCCUPANCY_GRID, latched=True)
MAP_METADATA = Topic(names.MAP_METADATA, types.MAP_META_DATA, latched=True)
SESSION = Topic(names.SESSION, types.SESSION, latched=True)
SEND_ROBOTS = Topic(names.SEND_ROBOTS, types.STRING)
SUCCESS = Topic(names.SUCCESS, types.STRING)
GAME_EVENTS = Topic(names.GAME_EVENTS, types.GAME_EVENT)
SCORE = Topic(names.SCORE, types.SCORE, latched=True)
ROOMS = Topic(names.ROOMS, types.MARKER_ARRAY, latched=True)
UTTERANCES = Topic(names.UTTERANCES, types.UTTERANCE)
DIALOGUE_MOVES = Topic(names.DIALOGUE_MOVES, types.DIALOGUE_MOVE)
DIALOGUE_STATES = Topic(names.DIALOGUE_STATES, types.DIALOGUE_STATE)
WIZARD = Topic(names.WIZARD, types.STRING, latched=True)
TEAM = Topic(names.TEAM, types.GAME_EVENT)
SHOWN = Topic(names.SHOWN, types.SEAT_NOTICE)
INPUTS = Topic(names.INPUTS, types.INPUT)
THINGS = Topic(names.THINGS, types.MARKER_ARRAY, latched=True)
ROSOUT = Topic(names.ROSOUT, types.LOG)
DIAGNOSTICS = Topic(names.DIAGNOSTICS, types.DIAGNOSTIC_ARRAY)

TEAM_TOPICS = (
    TF,
    TF_STATIC,
    MAP,
    MAP_METADATA,
    SESSION,
    SEND_ROBOTS,
    SUCCESS,
    GAME_EVENTS,
    SCORE,
    ROOMS,
    UTTERANCES,
    DIALOGUE_MOVES,
    DIALOGUE_STATES,
    WIZARD,
    TEAM,
    SHOWN,
    INPUTS,
    THINGS,
    ROSOUT,
    DIAGNOSTICS,
)
"""Topics that do not belong to a single robot."""


@dataclass(frozen=True, slots=True)
class Planners:
    """Names of a robot's planners. In move_base, the topics of plans contain these names."""

    base_global_planner: str = "NavfnROS"
    base_local_planner: str = "TrajectoryPlannerROS"

    @classmethod
    def of(cls, parameters: RobotParameters) -> "Planners":
        """Return the planners of a robot. For example, "navfn/NavfnROS" becomes "NavfnROS"."""
        chosen = parameters.move_base
        # The name of an installed planner may contain characters that ROS does not allow.
        planner = re.sub(r"\W", "_", chosen.base_global_planner.rpartition("/")[2], flags=re.ASCII)
        return cls(planner, chosen.base_local_planner.rpartition("/")[2])


class VehicleTopics:
    """Topics of one robot as a MAVLink vehicle, with mavros' names.

    Attributes:
        sent: topic of the frames that it sends.
        received: topic of the frames that it receives on any link.
        state: topic of its state.
    """

    def __init__(self, robot: RobotNames) -> None:
        self.sent = Topic(robot.topic("mavlink/from"), types.MAVLINK)
        self.received = Topic(robot.topic("mavlink/to"), types.MAVLINK)
        self.state = Topic(robot.topic("mavros/state"), types.MAVROS_STATE, latched=True)

    def all(self) -> tuple[Topic, ...]:
        """Return all of these topics."""
        return self.sent, self.received, self.state


P_WRONG = "p_wrong"
"""Last word of a topic's name. The topic contains the probability that a robot's pose is wrong."""
OF_ERRORS = frozenset({"believed_pose", "position_error", "heading_error", "lost", P_WRONG})
"""Last words of the topics that show the errors of a robot's pose estimate."""


def is_of_errors(topic: Topic) -> bool:
    """Return True for a topic that a recording omits if the study has `recording: errors: false`."""
    return topic.name.rpartition("/")[2] in OF_ERRORS


class RobotTopics:
    """Topics of one robot."""

    def __init__(self, robot: RobotNames, planners: Planners) -> None:
        self.odom = Topic(robot.topic("odom"), types.ODOMETRY)
        self.base_pose_ground_truth = Topic(robot.topic("base_pose_ground_truth"), types.ODOMETRY)
        self.scan = Topic(robot.topic("scan"), types.LASER_SCAN)
        self.amcl_pose = Topic(robot.topic("amcl_pose"), types.POSE_WITH_COVARIANCE, latched=True)
        # No ROS node has these topics. They show the errors of the robot's pose estimate.
        self.believed_pose = Topic(robot.topic("believed_pose"), types.POSE_STAMPED)
        self.position_error = Topic(robot.topic("position_error"), types.FLOAT64)
        self.heading_error = Topic(robot.topic("heading_error"), types.FLOAT64)
        self.lost = Topic(robot.topic("lost"), types.BOOL, latched=True)
        self.p_wrong = Topic(robot.topic(P_WRONG), types.FLOAT64)
        self.particlecloud = Topic(robot.topic("particlecloud"), types.POSE_ARRAY, latched=True)
        self.initialpose = Topic(robot.topic("initialpose"), types.POSE_WITH_COVARIANCE)
        self.cmd_vel = Topic(robot.topic("cmd_vel"), types.TWIST)
        self.battery = Topic(robot.topic("battery"), types.BATTERY_STATE)
        self.simple_goal = Topic(robot.topic("move_base_simple/goal"), types.POSE_STAMPED)
        self.goal = Topic(robot.topic("move_base/goal"), types.MOVE_BASE_GOAL)
        self.cancel = Topic(robot.topic("move_base/cancel"), types.GOAL_ID)
        self.status = Topic(robot.topic("move_base/status"), types.GOAL_STATUS_ARRAY, latched=True)
        self.feedback = Topic(robot.topic("move_base/feedback"), types.MOVE_BASE_FEEDBACK)
        self.result = Topic(robot.topic("move_base/result"), types.MOVE_BASE_RESULT)
        # ROS repeats its plans. Our plans are latched and only published after a change. The last plan is empty.
        self.plan = Topic(robot.topic(f"move_base/{planners.base_global_planner}/plan"), types.PATH, latched=True)
        self.local_plan = Topic(
            robot.topic(f"move_base/{planners.base_local_planner}/local_plan"), types.PATH, latched=True
        )
        # costmap_2d sends its last costmap to every new subscriber. So the topic behaves like a latched topic.
        self.global_costmap = Topic(robot.topic("move_base/global_costmap/costmap"), types.OCCUPANCY_GRID, latched=True)
        self.local_costmap = Topic(robot.topic("move_base/local_costmap/costmap"), types.OCCUPANCY_GRID, latched=True)
        self.global_footprint = Topic(robot.topic("move_base/global_costmap/footprint"), types.POLYGON_STAMPED)
        self.local_footprint = Topic(robot.topic("move_base/local_costmap/footprint"), types.POLYGON_STAMPED)

    def all(self) -> tuple[Topic, ...]:
        """Return all of these topics."""
        return tuple(vars(self).values())
