"""Inputs to a team from outside: requests to its robots, and changes to robots and world.

All are plain values, so that a recording can hold them and a run can be repeated. Recordings use the names in
`TEAM_INPUTS` and the names of the fields. The software of a dead robot ignores requests.
"""

from dataclasses import dataclass

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.numerics.float_array import FloatArray
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.view import CostmapName
from sim.robot.navigator.goals import Goal
from sim.world.thing import Thing


@dataclass(frozen=True, slots=True)
class SendGoal:
    """Send a robot to a goal. It gives up its present goal, if any."""

    robot: int
    goal: Goal


@dataclass(frozen=True, slots=True)
class CancelGoal:
    """Cancel a robot's goal (actionlib: cancel)."""

    robot: int


@dataclass(frozen=True, slots=True)
class DriveManually:
    """Drive by hand (ROS: cmd_vel): replace the navigator's commands for a number of ticks. The robot's goal ends.

    Attributes:
        command: wanted velocity. If it exceeds the limits of the motors, the robot drives at these limits.
        ticks: duration, at least 1. A further `DriveManually` before its end replaces it.
    """

    robot: int
    command: Twist
    ticks: int


@dataclass(frozen=True, slots=True, eq=False)
class SetPoseEstimate:
    """Set a robot's pose estimate (ROS: initialpose). Its localizer restarts there; pose and goal do not change.

    Attributes:
        covariance: (3, 3) covariance of x, y and theta; m^2, m rad, rad^2.
    """

    robot: int
    base_in_map: Pose2
    covariance: FloatArray


@dataclass(frozen=True, slots=True)
class GlobalLocalization:
    """Make a robot forget its pose and search for it on the whole map (ROS: global_localization)."""

    robot: int


@dataclass(frozen=True, slots=True)
class NomotionUpdate:
    """Let a robot use its next scan even if it stands still (ROS: request_nomotion_update)."""

    robot: int


@dataclass(frozen=True, slots=True)
class ClearCostmaps:
    """Let both costmaps of a robot forget what the laser has seen (ROS: move_base/clear_costmaps)."""

    robot: int


@dataclass(frozen=True, slots=True)
class ClearCostmapRegion:
    """Let one costmap of a robot forget what the laser has seen in a region (Nav2: clear_around_local_costmap etc.).

    Attributes:
        costmap: name of the costmap.
        side: side of a square along the axes of the costmap, meters. If None, the region is the whole costmap.
        middle: middle of the square in the map. If None, the robot's pose estimate.
        outside: True if the region is outside the square.
    """

    robot: int
    costmap: CostmapName
    side: float | None = None
    middle: Pose2 | None = None
    outside: bool = False


@dataclass(frozen=True, slots=True)
class SetSoftwareParameters:
    """Change the parameters of a robot's software while it runs (ROS: dynamic_reconfigure).

    Attributes:
        parameters: all parameters. They may differ from the present parameters only where
            `sim.parameters.reconfigured` allows a change.
    """

    robot: int
    parameters: RobotParameters


@dataclass(frozen=True, slots=True)
class SetWorldParameters:
    """Change a robot's true sensor noise. Its software is not informed.

    Attributes:
        parameters: the robot's true parameters. They may differ from the present parameters only where
            `sim.parameters.reconfigured` allows a change.
    """

    robot: int
    parameters: WorldParameters


@dataclass(frozen=True, slots=True)
class SetCharge:
    """Set the remaining energy of a robot."""

    robot: int
    charge: float


@dataclass(frozen=True, slots=True)
class PlaceRobot:
    """Put a robot at a pose and set its estimate to this pose (a restart, not a kidnapping)."""

    robot: int
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class PutThing:
    """Put a thing into the world as soon as its place is free. It replaces a thing of the same name."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class RemoveThing:
    """Remove the thing with this name."""

    name: str


@dataclass(frozen=True, slots=True)
class KidnapRobot:
    """Kidnap a robot: move it to a pose as soon as no other body stands there. Its software is not informed."""

    robot: int
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class KillRobot:
    """Kill a robot: its motors brake, its software stops, and its goal ends."""

    robot: int


@dataclass(frozen=True, slots=True)
class ReviveRobot:
    """Revive a dead robot: it continues where it stands, with its last pose estimate."""

    robot: int


TeamInput = (
    SendGoal
    | CancelGoal
    | DriveManually
    | SetPoseEstimate
    | GlobalLocalization
    | NomotionUpdate
    | ClearCostmaps
    | ClearCostmapRegion
    | SetSoftwareParameters
    | SetWorldParameters
    | SetCharge
    | PlaceRobot
    | PutThing
    | RemoveThing
    | KidnapRobot
    | KillRobot
    | ReviveRobot
)

TEAM_INPUTS: dict[str, type[TeamInput]] = {
    "Go": SendGoal,
    "Halt": CancelGoal,
    "Drive": DriveManually,
    "Localize": SetPoseEstimate,
    "Globalize": GlobalLocalization,
    "RequestUpdate": NomotionUpdate,
    "ClearCostmaps": ClearCostmaps,
    "ClearCostmapRegion": ClearCostmapRegion,
    "Configure": SetSoftwareParameters,
    "Disturb": SetWorldParameters,
    "SetCharge": SetCharge,
    "Place": PlaceRobot,
    "PutThing": PutThing,
    "RemoveThing": RemoveThing,
    "Carry": KidnapRobot,
    "Die": KillRobot,
    "Revive": ReviveRobot,
}
"""Inputs by their names in recordings and in messages of watch clients. These names never change."""


@dataclass(frozen=True, slots=True)
class ScheduledInput:
    """An input that is known before the run, and its tick."""

    tick: int
    input: TeamInput
