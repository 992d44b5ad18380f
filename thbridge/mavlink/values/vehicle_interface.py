"""Interface between a vehicle and its robot: commands that a ground station may give, and readings of the robot.

A vehicle handles MAVLink and does not depend on the game. The implementation of `VehicleInterface` handles the
robot and the game, and does not depend on MAVLink.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import Literal, Protocol

from sim.common.geometry import IDENTITY, Pose2
from sim.common.observations import STANDSTILL, Twist


@dataclass(frozen=True, slots=True)
class Station:
    """Sender of messages to vehicles, such as a ground station, a companion computer or a script.

    Attributes:
        system: its system id. Most ground stations have the id 255.
        component: its component id.
    """

    system: int
    component: int

    def __str__(self) -> str:
        return f"ground station {self.system}"


PARTICIPANT = "participant"
"""Name of the participant in `RobotReadings`, in a game with one participant."""


class DenialKind(Enum):
    """Kind of a denial."""

    DENIED = "denied"
    NOT_NOW = "not now"
    UNSUPPORTED = "unsupported"


@dataclass(frozen=True, slots=True)
class Denied:
    """Denial of a command.

    Attributes:
        sentence: reason for people, at most about 100 characters.
        kind: kind of denial. `NOT_NOW` means that a later attempt may succeed.
        axis: axis of the map along which a point is outside the map. None for every other reason.
        is_done: True if the command was executed before and must not be executed again.
    """

    sentence: str
    kind: DenialKind = DenialKind.DENIED
    axis: Literal["x", "y"] | None = None
    is_done: bool = False


@dataclass(frozen=True, slots=True)
class Target:
    """Goal of a robot.

    Attributes:
        x: meters east, map.
        y: meters north, map.
        heading: radians from east, counterclockwise. If None, any heading is allowed.
    """

    x: float
    y: float
    heading: float | None = None


@dataclass(frozen=True, slots=True)
class HelmLeg:
    """Progress of the last `VehicleInterface.go_to`.

    Attributes:
        number: number that `go_to` returned.
        state: "under way", "arrived" or "failed". A state "arrived" or "failed" remains until the next leg.
        remaining: meters left to drive. 0 after the end of the leg.
        reason: reason for a failure, for people.
    """

    number: int
    state: "LegState"
    remaining: float = 0.0
    reason: str = ""


class LegState(StrEnum):
    """State of a leg."""

    UNDER_WAY = "under way"
    ARRIVED = "arrived"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class RobotReadings:
    """State of a robot after one tick, by its own estimates.

    Attributes:
        base_in_map: estimated pose: x east and y north, meters, theta from east, counterclockwise.
        twist: velocity by its own odometry, m/s and rad/s.
        goal_in_map: its current goal, from any source. None if it has no goal.
        energy: remaining energy in the game's units.
        capacity: energy at the start, in the same units.
        responsive: False if its software does not respond. Then all other values are those of its last response.
        lost: True if it does not know its position.
        under_way: True while it drives to a goal from any source.
        commander: the ground station that commands it, as text of `Station`. None if no station commands it.
        commanded_by: its commander for people: "participant", "ground station 255", "researcher"; in a game with
            several seats, the name of a seat.
        leg: progress of the last `go_to`. None before the first `go_to`.
        announcements: texts of this tick for people at ground stations, about a reached room, a found treasure or a
            refusal by the game. Each text has at most about 100 characters.
        participant_requests: texts of this tick with the participant's requests to the station that commands the
            robot. Each text has at most about 100 characters.
        participant: the participant who commands the robot when no other party commands it, as in `commanded_by`.
    """

    base_in_map: Pose2
    twist: Twist
    goal_in_map: Pose2 | None
    energy: float
    capacity: float
    responsive: bool
    lost: bool
    under_way: bool
    commander: str | None
    commanded_by: str
    leg: HelmLeg | None
    announcements: tuple[str, ...] = ()
    participant_requests: tuple[str, ...] = ()
    participant: str = PARTICIPANT


NO_READINGS = RobotReadings(
    base_in_map=IDENTITY,
    twist=STANDSTILL,
    goal_in_map=None,
    energy=0.0,
    capacity=0.0,
    responsive=False,
    lost=False,
    under_way=False,
    commander=None,
    commanded_by=PARTICIPANT,
    leg=None,
)
"""Readings before the first tick."""


@dataclass(frozen=True, slots=True)
class ParameterSetting:
    """Numeric parameter in MAVLink's form.

    Attributes:
        name: its name, at most 16 characters of A-Z, 0-9 and _.
        value: value that a 32-bit float can hold.
    """

    name: str
    value: float


@dataclass(frozen=True, slots=True)
class ParameterDescription:
    """Description of a numeric parameter, for people who set it.

    Attributes:
        name: its name.
        meaning: one sentence.
        details: further explanation.
        section: section of the study file that contains it.
        group: name of its group of parameters.
        unit: SI unit. Empty for a pure number.
        default: initial value. None if the robots have different values.
        minimum: minimum value. If None, there is no limit.
        maximum: maximum value. If None, there is no limit.
        whole: True for whole numbers.
        words: meanings of the values 0, 1, 2, .... Empty for plain numbers.
        fixed: True if it cannot be changed.
    """

    name: str
    meaning: str
    details: str
    section: str
    group: str
    unit: str = ""
    default: float | None = None
    minimum: float | None = None
    maximum: float | None = None
    whole: bool = False
    words: tuple[str, ...] = ()
    fixed: bool = False


class ParameterSettings(Protocol):
    """Numeric parameters of a robot."""

    def descriptions(self) -> Sequence[ParameterDescription]:
        """Return the description of each parameter, in the order of `settings`. The result never changes."""

    def settings(self) -> Sequence[ParameterSetting]:
        """Return all parameters, always in the same order, with current or pending values."""

    def change(self, name: str, value: float) -> ParameterSetting | Denied:
        """Change the parameter of this name and return its new value. The parameter must exist."""


class VehicleInterface(Protocol):
    """Controls of a robot. Each call returns at once. A granted command has an effect in the next tick."""

    @property
    def parameters(self) -> ParameterSettings:
        """Parameters of the robot."""

    def take(self, station: Station) -> Denied | None:
        """Let this station command the robot instead of any other commander. A repeated call has no effect."""

    def release(self) -> None:
        """Let the participant command the robot again. A current leg continues unless it was stopped before."""

    def go_to(self, target: Target) -> int | Denied:
        """Send the robot to a point of the map. This replaces the current leg.

        If the point is in a room, the drive is a move of the game, and ends at the goal pose of that room.

        Returns:
            The number of the leg. `RobotReadings.leg` shows its result.
        """

    def stop_robot(self) -> None:
        """Stop the robot, and abort the current leg or move of the game, even if another commander ordered it."""

    def drive(self, twist: Twist) -> Denied | None:
        """Drive by hand for the next half second."""

    def fastest(self) -> Twist:
        """Return the speed limits of manual driving, m/s and rad/s, both positive."""

    def limit_speed(self, speed: float) -> Denied | None:
        """Limit the speed from now on, m/s. A negative value restores the study's limit."""

    def start(self) -> Pose2:
        """Return the start pose, map frame."""

    def misplaced(self, x: float, y: float) -> Denied | None:
        """Return a denial if the robot can never stand at a point of the map. Moving obstacles are ignored.

        Args:
            x: meters east.
            y: meters north.
        """

    def unreachable(self, x: float, y: float) -> Denied | None:
        """Return a denial if `go_to` can never lead to a point of the map. For points in rooms, the game decides.

        Args:
            x: meters east.
            y: meters north.
        """

    def photograph(self) -> Denied | None:
        """Take a picture in the room where the robot stands."""

    def identify(self, number: int) -> Denied | None:
        """Identify the treasure in the robot's room by the number of its name, from 1, in alphabetical order."""

    def leave(self) -> Denied | None:
        """Leave the treasure where it is, in the robot's room."""
