"""Inputs of a team from outside: requests to its robots, and things that happen to them.

All are plain values, so that a recording can hold them and a run can be repeated: recordings hold the names in
`TEAM_INPUTS` and those of the fields. A dead robot's software takes no requests.
"""

from dataclasses import dataclass

from sim.common.geometry import FloatArray, Pose2
from sim.common.observations import Twist
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.navigator import Goal
from sim.world.things import Thing


@dataclass(frozen=True, slots=True)
class Go:
    """Send a robot to a goal; the goal that it is driving to, if any, is given up for it."""

    robot: int
    goal: Goal


@dataclass(frozen=True, slots=True)
class Halt:
    """Withdraw a robot's goal."""

    robot: int


@dataclass(frozen=True, slots=True)
class Drive:
    """Drive by hand (ROS: cmd_vel): this command instead of the navigator's, for so many ticks; a goal ends for it.

    Attributes:
        command: may ask for more than the motors can: they do what they can.
        ticks: at least 1; another one that comes before they are over takes its place.
    """

    robot: int
    command: Twist
    ticks: int


@dataclass(frozen=True, slots=True, eq=False)
class Localize:
    """Tell a robot where it is (ROS: initialpose): its localiser begins anew there; body and goal stay.

    Attributes:
        covariance: (3, 3) of x, y and theta, how sure; m^2, m rad, rad^2.
    """

    robot: int
    base_in_map: Pose2
    covariance: FloatArray


@dataclass(frozen=True, slots=True)
class Globalize:
    """Let a robot forget where it is (ROS: global_localization)."""

    robot: int


@dataclass(frozen=True, slots=True)
class RequestUpdate:
    """Let a robot weigh its next scan even if it stands (ROS: request_nomotion_update)."""

    robot: int


@dataclass(frozen=True, slots=True)
class ClearCostmaps:
    """Let both costmaps of a robot forget what the laser has seen (ROS: move_base/clear_costmaps)."""

    robot: int


@dataclass(frozen=True, slots=True)
class Configure:
    """Change the parameters of a robot's software while it runs (ROS: dynamic_reconfigure).

    Attributes:
        parameters: all of them; they may differ from those it has where `sim.parameters.reconfigured` could have made
            them differ.
    """

    robot: int
    parameters: RobotParameters


@dataclass(frozen=True, slots=True)
class Disturb:
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
class Place:
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
class Carry:
    """Kidnap a robot: it is put somewhere else, as soon as no body stands there, and is told nothing."""

    robot: int
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class Die:
    """Kill a robot: its motors brake for good, its software stops and its goal is gone."""

    robot: int


@dataclass(frozen=True, slots=True)
class Revive:
    """Revive a dead robot: it goes on where it stands, believing what it believed."""

    robot: int


TeamInput = (
    Go
    | Halt
    | Drive
    | Localize
    | Globalize
    | RequestUpdate
    | ClearCostmaps
    | Configure
    | Disturb
    | SetCharge
    | Place
    | PutThing
    | RemoveThing
    | Carry
    | Die
    | Revive
)

TEAM_INPUTS: dict[str, type[TeamInput]] = {
    "Go": Go,
    "Halt": Halt,
    "Drive": Drive,
    "Localize": Localize,
    "Globalize": Globalize,
    "RequestUpdate": RequestUpdate,
    "ClearCostmaps": ClearCostmaps,
    "Configure": Configure,
    "Disturb": Disturb,
    "SetCharge": SetCharge,
    "Place": Place,
    "PutThing": PutThing,
    "RemoveThing": RemoveThing,
    "Carry": Carry,
    "Die": Die,
    "Revive": Revive,
}
"""Inputs by their names in recordings and at the watch port, which do not change."""


@dataclass(frozen=True, slots=True)
class ScheduledInput:
    """An input that is due at a tick and known before the run."""

    tick: int
    input: TeamInput
