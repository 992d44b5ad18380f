"""The seam between a vehicle and its robot: what a ground station may ask of the robot, and what it is told of it.

A vehicle speaks MAVLink and knows no game; whoever holds the helm knows both robot and game, and no MAVLink.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum, StrEnum
from typing import Protocol

from sim.common.geometry import IDENTITY, Pose2
from sim.common.observations import STANDSTILL, Twist


@dataclass(frozen=True, slots=True)
class Station:
    """Whoever speaks to vehicles: a ground station, a companion computer, a script.

    Attributes:
        system: its system id, as 255 of most ground stations.
        component: its component id.
    """

    system: int
    component: int

    def __str__(self) -> str:
        return f"ground station {self.system}"


PARTICIPANT = "participant"
"""The words for the participant in `Readings.commanded_by`."""


class DenialKind(Enum):
    """How firmly something is refused."""

    DENIED = "denied"
    NOT_NOW = "not now"
    UNSUPPORTED = "unsupported"


@dataclass(frozen=True, slots=True)
class Denied:
    """Why the robot does not do it.

    Attributes:
        sentence: for people, of at most some 100 characters.
        refusal: how firmly; `NOT_NOW` where asking again later may help.
    """

    sentence: str
    refusal: DenialKind = DenialKind.DENIED


@dataclass(frozen=True, slots=True)
class Target:
    """Where a robot is to go.

    Attributes:
        x: metres east, map.
        y: metres north, map.
        heading: radians from east, anticlockwise; None: any.
    """

    x: float
    y: float
    heading: float | None = None


@dataclass(frozen=True, slots=True)
class HelmLeg:
    """Where a robot was last told to go from its helm.

    Attributes:
        number: that `Helm.go_to` gave it.
        state: "under way", "arrived" or "failed"; the last two stay until the next leg.
        remaining: metres still to drive; 0 when it is over.
        reason: why it failed, for people.
    """

    number: int
    state: "LegState"
    remaining: float = 0.0
    reason: str = ""


class LegState(StrEnum):
    """How a leg stands."""

    UNDER_WAY = "under way"
    ARRIVED = "arrived"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class RobotReadings:
    """A robot as its own software knows it, after one tick.

    Attributes:
        base_in_map: where it believes it is; x east, y north, metres; theta from east, anticlockwise.
        twist: how it moves by its own odometry.
        goal_in_map: where it is bound for, whoever sent it; None at rest.
        energy: what it has left, in the game's units.
        capacity: what it had at the start, in the same.
        answers: whether its software says anything; everything else is as it was when it last did.
        lost: it does not know where it is.
        under_way: it drives to a goal, whoever sent it.
        commander: the station in command of it, by its words (`Station`); None when no station is.
        commanded_by: who is in command, for people: "participant", "ground station 255", "researcher".
        leg: where it was last told to go from here; None before the first.
        news: what has come up in this tick and people at ground stations should know: a room reached, what was found
            in it, what the game refused; sentences of at most some 100 characters.
        asked: what in this tick the participant asks of the station in command, likewise.
    """

    base_in_map: Pose2
    twist: Twist
    goal_in_map: Pose2 | None
    energy: float
    capacity: float
    answers: bool
    lost: bool
    under_way: bool
    commander: str | None
    commanded_by: str
    leg: HelmLeg | None
    news: tuple[str, ...] = ()
    asked: tuple[str, ...] = ()


NOTHING_KNOWN = RobotReadings(
    base_in_map=IDENTITY,
    twist=STANDSTILL,
    goal_in_map=None,
    energy=0.0,
    capacity=0.0,
    answers=False,
    lost=False,
    under_way=False,
    commander=None,
    commanded_by=PARTICIPANT,
    leg=None,
)
"""Before the first tick."""


@dataclass(frozen=True, slots=True)
class ParameterSetting:
    """A numeric parameter as MAVLink has it.

    Attributes:
        name: at most 16 characters of A-Z, 0-9 and _.
        value: as a 32-bit float tells it.
    """

    name: str
    value: float


@dataclass(frozen=True, slots=True)
class ParameterDescription:
    """What a numeric parameter means, for people who set it.

    Attributes:
        name: its name.
        meaning: one sentence.
        details: what else is to be known of it.
        section: of the study that it stands in.
        group: of those that belong together, by the name of what has them.
        unit: SI; empty for a pure number.
        default: what it is at first; None where that is another one for each robot.
        minimum: least value; None where there is none.
        maximum: greatest value.
        whole: it has no fraction.
        words: what 0, 1, 2... stand for; empty where numbers are numbers.
        fixed: nobody can change it.
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
    """Numeric parameters."""

    def descriptions(self) -> Sequence[ParameterDescription]:
        """What each of them means, in the order of `settings`; always the same."""

    def settings(self) -> Sequence[ParameterSetting]:
        """All of them, always in the same order, as they are or are about to be."""

    def setting(self, name: str) -> ParameterSetting | None:
        """One of them; None: there is none of this name."""

    def change(self, name: str, value: float) -> ParameterSetting | Denied:
        """Change one of this name, which exists; what it is now."""


class VehicleInterface(ParameterSettings, Protocol):
    """A robot's controls. Each call answers at once; what is granted is done with the next tick."""

    def take(self, station: Station) -> Denied | None:
        """Put this station in command; the participant and others then are not. Taking it twice does no harm."""

    def release(self) -> None:
        """Give the command back to the participant; a leg under way goes on, unless it was halted before."""

    def go_to(self, target: Target) -> int | Denied:
        """Send the robot to a point of the map; another leg under way is given up for it.

        A point in a room is a move of the game, and ends at that room's own place.

        Returns:
            The number of the leg; `Readings.leg` tells how it ends.
        """

    def halt(self) -> None:
        """Stop, and give up the leg under way, or the game's move, whoever ordered it."""

    def drive(self, twist: Twist) -> Denied | None:
        """Drive by hand for the next half second."""

    def fastest(self) -> Twist:
        """The fastest that a hand can drive it: m/s and rad/s, both positive."""

    def limit_speed(self, speed: float) -> Denied | None:
        """From now on drive at most this fast, m/s; a negative one: as the study says."""

    def start(self) -> Pose2:
        """Where the robot started, map frame."""

    def misplaced(self, x: float, y: float) -> Denied | None:
        """Why the robot could stand at no time at a point of the map; None: it could, whoever is there just now.

        Args:
            x: metres east.
            y: metres north.
        """

    def photograph(self) -> Denied | None:
        """Take a picture of what is in the room where the robot stands."""

    def identify(self, number: int) -> Denied | None:
        """Say what the treasure in the robot's room is: the number of its name, from 1, in alphabetical order."""

    def leave(self) -> Denied | None:
        """Give the treasure in the robot's room up."""
