"""Inputs of a team from outside: requests to its robots, and things that happen to them.

All are plain values, so that a recording can hold them and a run can be repeated: recordings hold the names in
`TEAM_INPUTS` and those of the fields. A dead robot's software takes no requests.
"""

from dataclasses import dataclass

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.numerics.float_array import FloatArray
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.navigator.goals import Goal
from sim.world.thing import Thing


@dataclass(frozen=True, slots=True)
class SendGoal:
    """Send a robot to a goal; the goal that it is driving to, if any, is given up for it."""

    robot: int
    goal: Goal


@dataclass(frozen=True, slots=True)
class CancelGoal:
    """Cancel a robot's goal (actionlib: cancel)."""

    robot: int


@dataclass(frozen=True, slots=True)
class DriveManually:
    """Drive by hand (ROS: cmd_vel): this command instead of the navigator's, for so many ticks; a goal ends for it.

    Attributes:
        command: may ask for more than the motors can: they do what they can.
        ticks: at least 1; another one that comes before they are over takes its place.
    """

    robot: int
    command: Twist
    ticks: int


@dataclass(frozen=True, slots=True, eq=False)
class SetPoseEstimate:
    """Tell a robot where it is (ROS: initialpose): its localizer begins anew there; body and goal stay.

    Attributes:
        covariance: (3, 3) of x, y and theta, how sure; m^2, m rad, rad^2.
    """

    robot: int
    base_in_map: Pose2
    covariance: FloatArray


@dataclass(frozen=True, slots=True)
class GlobalLocalization:
    """Let a robot forget where it is (ROS: global_localization)."""

    robot: int


@dataclass(frozen=True, slots=True)
class NomotionUpdate:
    """Let a robot weigh its next scan even if it stands (ROS: request_nomotion_update)."""

    robot: int


@dataclass(frozen=True, slots=True)
class ClearCostmaps:
    """Let both costmaps of a robot forget what the laser has seen (ROS: move_base/clear_costmaps)."""

    robot: int


@dataclass(frozen=True, slots=True)
class SetSoftwareParameters:
    """Change the parameters of a robot's software while it runs (ROS: dynamic_reconfigure).

    Attributes:
        parameters: all of them; they may differ from those it has where `sim.parameters.reconfigured` could have made
            them differ.
    """

    robot: int
    parameters: RobotParameters


@dataclass(frozen=True, slots=True)
class SetWorldParameters:
    """Let a robot's sensors err otherwise from now on; its software, if it lives, is told nothing.

    Attributes:
        parameters: the robot's true ones; they may differ from those before where `sim.parameters.reconfigured` could
            have made them differ.
    """

    robot: int
    parameters: WorldParameters


@dataclass(frozen=True, slots=True)
class SetCharge:
    """Set the energy that a robot has left."""

    robot: int
    charge: float


@dataclass(frozen=True, slots=True)
class PlaceRobot:
    """Put a robot somewhere, and tell it so (a restart, not a kidnapping)."""

    robot: int
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class PutThing:
    """Put a thing in the way, as soon as its place is free; one of the same name vanishes."""

    thing: Thing


@dataclass(frozen=True, slots=True)
class RemoveThing:
    """Take the thing of this name away."""

    name: str


@dataclass(frozen=True, slots=True)
class KidnapRobot:
    """Kidnap a robot: it is put somewhere else, as soon as no body stands there, and is told nothing."""

    robot: int
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class KillRobot:
    """Kill a robot: its motors brake for good, its software stops and its goal is gone."""

    robot: int


@dataclass(frozen=True, slots=True)
class ReviveRobot:
    """Revive a dead robot: it goes on where it stands, believing what it believed."""

    robot: int


TeamInput = (
    SendGoal
    | CancelGoal
    | DriveManually
    | SetPoseEstimate
    | GlobalLocalization
    | NomotionUpdate
    | ClearCostmaps
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
"""Inputs by their names in recordings and at the watch port, which do not change."""


@dataclass(frozen=True, slots=True)
class ScheduledInput:
    """An input that is due at a tick and known before the run."""

    tick: int
    input: TeamInput
