"""Interface between a vehicle and its robot: the commands that a ground station may give, and the robot's readings.

A vehicle handles MAVLink and knows nothing about the game. The implementation of `VehicleInterface` handles robot and
game, and knows nothing about MAVLink.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import Literal, Protocol

from sim.common.geometry import IDENTITY, Pose2
from sim.common.observations import STANDSTILL, Twist


@dataclass(frozen=True, slots=True)
class Station:
    """Sender of messages to vehicles: a ground station, a companion computer, a script.

    Attributes:
        system: its system id; most ground stations have 255.
        component: its component id.
    """

    system: int
    component: int

    def __str__(self) -> str:
        return f"ground station {self.system}"


PARTICIPANT = "participant"
"""Name of the participant in `RobotReadings.commanded_by`."""


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
        kind: kind of denial; `NOT_NOW` if a later attempt may succeed.
        axis: axis of the map along which a point is off the map; None for every other reason.
        is_done: True if it was done before and must not be done again.
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
        heading: radians from east, anticlockwise; None for any heading.
    """

    x: float
    y: float
    heading: float | None = None


@dataclass(frozen=True, slots=True)
class HelmLeg:
    """Progress of the last `VehicleInterface.go_to`.

    Attributes:
        number: number that `go_to` returned.
        state: "under way", "arrived" or "failed"; the last two states remain until the next leg.
        remaining: meters left to drive; 0 after its end.
        reason: reason of a failure, for people.
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
        base_in_map: estimated pose; x east, y north, meters; theta from east, anticlockwise.
        twist: velocity by its own odometry, m/s and rad/s.
        goal_in_map: its current goal, from any source; None at rest.
        energy: remaining energy in the game's units.
        capacity: energy at the start, in the same units.
        responsive: False if its software does not respond; all other values are then those of its last response.
        lost: True if it has lost its position.
        under_way: True while it drives to a goal from any source.
        commander: the station in command, as text of `Station`; None if no station commands.
        commanded_by: its commander for people: "participant", "ground station 255", "researcher".
        leg: progress of the last `go_to`; None before the first.
        announcements: texts of this tick for people at ground stations: a room reached, a treasure found, a refusal by
            the game; at most about 100 characters each.
        participant_requests: texts of this tick with requests of the participant to the station in command; at most
            about 100 characters each.
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
        group: name of the group of parameters it belongs to.
        unit: SI; empty for a pure number.
        default: initial value; None if it differs between robots.
        minimum: smallest value; None if unlimited.
        maximum: largest value.
        whole: True for whole numbers.
        words: meanings of the values 0, 1, 2...; empty for plain numbers.
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
        """Return the description of each parameter, in the order of `settings`; the result never changes."""

    def settings(self) -> Sequence[ParameterSetting]:
        """Return all parameters, always in the same order, with current or pending values."""

    def change(self, name: str, value: float) -> ParameterSetting | Denied:
        """Change the parameter of this name, which must exist, and return its new value."""


class VehicleInterface(Protocol):
    """Controls of a robot. Each call returns at once; a granted command takes effect in the next tick."""

    @property
    def parameters(self) -> ParameterSettings:
        """Parameters of the robot."""

    def take(self, station: Station) -> Denied | None:
        """Put this station in command instead of any other. A repeated call has no effect."""

    def release(self) -> None:
        """Return command to the participant; a current leg continues unless it was stopped before."""

    def go_to(self, target: Target) -> int | Denied:
        """Send the robot to a point of the map; this replaces the current leg.

        A point in a room is a move of the game, and ends at the goal pose of that room.

        Returns:
            The number of the leg; `RobotReadings.leg` shows how it ends.
        """

    def stop_robot(self) -> None:
        """Stop the robot, and abort the current leg or move of the game, regardless of who ordered it."""

    def drive(self, twist: Twist) -> Denied | None:
        """Drive by hand for the next half second."""

    def fastest(self) -> Twist:
        """Return the speed limits of manual driving, m/s and rad/s, both positive."""

    def limit_speed(self, speed: float) -> Denied | None:
        """Limit the speed from now on, m/s; a negative value restores the study's limit."""

    def start(self) -> Pose2:
        """Return the start pose, map frame."""

    def misplaced(self, x: float, y: float) -> Denied | None:
        """Return a denial if the robot can never stand at a point of the map; moving obstacles are ignored.

        Args:
            x: meters east.
            y: meters north.
        """

    def unreachable(self, x: float, y: float) -> Denied | None:
        """Return a denial if `go_to` can never lead to a point of the map; for points in rooms, the game decides.

        Args:
            x: meters east.
            y: meters north.
        """

    def photograph(self) -> Denied | None:
        """Take a picture in the room where the robot stands."""

    def identify(self, number: int) -> Denied | None:
        """Identify the treasure in the robot's room by the number of its name, from 1, in alphabetical order."""

    def leave(self) -> Denied | None:
        """Leave the treasure in the robot's room."""
