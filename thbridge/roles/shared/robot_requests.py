"""Requests to robots and the game from ROS clients, researchers' windows and ground stations."""

from collections.abc import Sequence
from dataclasses import dataclass

from sim.inputs import TEAM_INPUTS, TeamInput
from sim.parameters import RobotParameters, WorldParameters
from sim.parameters.reconfiguration import WORLD_PREFIX, ParameterRejection, with_values
from thbridge.ros.messages.records import (
    CancelRequest,
    GoalRequest,
    GraphRequest,
    InitialPose,
    SimpleGoal,
    VelocityCommand,
)

ParameterValue = bool | int | float | str | None
"""Value of a parameter. A list of corners is a text, `[[x, y], ...]`."""


@dataclass(frozen=True, slots=True)
class SetParameters:
    """Change parameters of a robot's software or of its true sensor noise during the session.

    Unlike `SetSoftwareParameters`, this request contains only the changed values. So it is valid for robots with
    different parameters.

    Attributes:
        robot: index in the team, from 0.
        values: new values, by path, such as `amcl.kld_err` or `world.laser.range_noise`. Either all values are changed,
            or none.
    """

    robot: int
    values: tuple[tuple[str, ParameterValue], ...]


@dataclass(frozen=True, slots=True)
class WizardMode:
    """Let a person speak for a robot (Wizard-of-Oz), or let its strategy speak again.

    Attributes:
        robot: index in the team, from 0.
        on: if True, the robot's turns wait for `WizardMove`, and its advice waits for `WizardAdvice`. If False, its
            strategy decides pending turns at once, and all later turns.
    """

    robot: int
    on: bool


@dataclass(frozen=True, slots=True)
class WizardMove:
    """Make a robot's next move in place of the robot's strategy.

    Attributes:
        dialogue: number of the dialogue.
        turn: index of the move in the dialogue, from 0. A move for an earlier turn is ignored.
        move: index of the move among the legal moves, from 0.
        text: sentence for the move. If empty, the move's own sentence is used.
    """

    dialogue: int
    turn: int
    move: int
    text: str = ""


@dataclass(frozen=True, slots=True)
class WizardAdvice:
    """Answer a participant's pending "don't know" for a robot.

    Attributes:
        robot: index in the team, from 0.
        room: number of the suggested room, from 1.
    """

    robot: int
    room: int


@dataclass(frozen=True, slots=True)
class TakeCommand:
    """A ground station takes command of a robot from the participant or from another ground station.

    Attributes:
        robot: index in the team, from 0; also in the requests below.
        name: name of the ground station for sentences.
    """

    robot: int
    name: str


@dataclass(frozen=True, slots=True)
class ReleaseCommand:
    """The ground station that commands a robot gives the robot back to the participant."""

    robot: int


@dataclass(frozen=True, slots=True)
class StationSend:
    """The ground station that commands a robot sends it to a room. The rules of the game apply; there is no dialogue.

    Attributes:
        room: number of the room, from 1.
    """

    robot: int
    room: int


@dataclass(frozen=True, slots=True)
class StationStop:
    """Stop a robot's move of the game. A ground station may request this even if it does not command the robot."""

    robot: int


@dataclass(frozen=True, slots=True)
class StationTakePicture:
    """The ground station that commands a robot takes a picture in the robot's room."""

    robot: int


@dataclass(frozen=True, slots=True)
class StationIdentify:
    """The ground station that commands a robot names the treasure in the robot's room."""

    robot: int
    name: str


@dataclass(frozen=True, slots=True)
class StationLeave:
    """The ground station that commands a robot leaves the treasure in the robot's room."""

    robot: int


@dataclass(frozen=True, slots=True)
class Pause:
    """Pause the session."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Resume the session."""


@dataclass(frozen=True, slots=True)
class SetRate:
    """Set the rate of simulated time.

    Attributes:
        rate: simulated seconds per second of real time. 0 means as fast as possible.
    """

    rate: float


@dataclass(frozen=True, slots=True)
class Step:
    """Run some ticks, and then pause.

    Attributes:
        ticks: number of ticks, at least 1.
    """

    ticks: int = 1


PaceRequest = Pause | Resume | SetRate | Step
"""A request about the pace of a session.

The request takes effect at once and does not change results, so it is not an input.
"""

WizardRequest = WizardMode | WizardMove | WizardAdvice
"""A request of a person who speaks for a robot (Wizard-of-Oz). The request takes effect in the next tick."""

CommandRequest = (
    TakeCommand | ReleaseCommand | StationSend | StationStop | StationTakePicture | StationIdentify | StationLeave
)
"""A request of a ground station to the game. It takes effect in the next tick. Refused requests are dropped."""

GameRequest = WizardRequest | CommandRequest
"""A request to the game from a party other than the participant."""

RobotRequest = TeamInput | GraphRequest | SetParameters
"""A request to a robot. It takes effect in the next tick. It delays a move of the game, but does not end the move."""

Request = RobotRequest | GameRequest
"""Request to a session. It is recorded as an input."""

REQUESTS: dict[str, type[Request]] = {
    **TEAM_INPUTS,
    "GoalRequest": GoalRequest,
    "CancelRequest": CancelRequest,
    "SimpleGoal": SimpleGoal,
    "VelocityCommand": VelocityCommand,
    "InitialPose": InitialPose,
    "SetParameters": SetParameters,
    "Puppeteer": WizardMode,
    "SpeakFor": WizardMove,
    "AdviseFor": WizardAdvice,
    "TakeCommand": TakeCommand,
    "ReleaseCommand": ReleaseCommand,
    "SendFor": StationSend,
    "CallBackFor": StationStop,
    "PictureFor": StationTakePicture,
    "IdentifyFor": StationIdentify,
    "LeaveFor": StationLeave,
}
"""Request types, by their names in recordings and at the watch port. These names never change."""

PACE_REQUESTS: dict[str, type[PaceRequest]] = {"Pause": Pause, "Resume": Resume, "SetRate": SetRate, "Step": Step}
"""Request types for the pace, by their names at the watch port."""


@dataclass(frozen=True, slots=True)
class Tuning:
    """All parameters of a robot that may be changed during a session.

    Attributes:
        software: parameters of the robot's software.
        world: true properties of the robot's body, motors and sensors.
    """

    software: RobotParameters
    world: WorldParameters

    def changed(self, values: Sequence[tuple[str, ParameterValue]]) -> "Tuning | ParameterRejection":
        """Return a copy with all these values, or the reason why one value is rejected.

        The order of values does not matter.
        """
        true = [(path, value) for path, value in values if path.startswith(WORLD_PREFIX)]
        own = [(path, value) for path, value in values if not path.startswith(WORLD_PREFIX)]
        software, world = with_values(self.software, own), with_values(self.world, true)
        if isinstance(software, ParameterRejection):
            return software
        return world if isinstance(world, ParameterRejection) else Tuning(software, world)
