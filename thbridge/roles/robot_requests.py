"""What may be asked of the robots beside the game, by whoever sits at their controls: ROS clients, windows."""

from collections.abc import Sequence
from dataclasses import dataclass

from sim.inputs import TeamInput
from sim.parameters import RobotParameters, WorldParameters
from sim.parameters.reconfiguration import WORLD_PREFIX, P, ParameterRejection, reconfigured
from thbridge.ros.messages.records import GraphRequest

ParameterValue = bool | int | float | str | None
"""Of one parameter; a list of corners comes as text, `[[x, y], ...]`."""


@dataclass(frozen=True, slots=True)
class SetParameters:
    """Change parameters of a robot's software, or how its true sensors err, while it runs.

    Unlike `Configure` it says what changes, and so means something to a robot whose other parameters are not the same.

    Attributes:
        robot: which.
        values: by path, such as `amcl.kld_err` or `world.laser.range_noise`. All are changed, or none.
    """

    robot: int
    values: tuple[tuple[str, ParameterValue], ...]


@dataclass(frozen=True, slots=True)
class Puppeteer:
    """Let a person speak for a robot (Wizard-of-Oz), or let its strategy speak again.

    Attributes:
        robot: which, from 0.
        on: from now on its turns in dialogues wait for `SpeakFor`, and its advice for `AdviseFor`; or what waits is
            decided by its strategy at once, and so is all that follows.
    """

    robot: int
    on: bool


@dataclass(frozen=True, slots=True)
class SpeakFor:
    """Make the move of a robot whose turn it is, for its strategy.

    Attributes:
        dialogue: number of the dialogue.
        turn: place of the move in the dialogue, from 0; a move for a turn that is past changes nothing.
        move: place among the legal moves, from 0.
        text: what is said instead of the sentence that belongs to the move; empty: that sentence.
    """

    dialogue: int
    turn: int
    move: int
    text: str = ""


@dataclass(frozen=True, slots=True)
class AdviseFor:
    """Answer a participant's "don't know" that waits for a robot's advice, for the robot.

    Attributes:
        robot: which, from 0.
        room: where it is to suggest to go; as people say it, from 1.
    """

    robot: int
    room: int


@dataclass(frozen=True, slots=True)
class TakeCommand:
    """A ground station takes command of a robot, whoever of the participant and other ground stations had it.

    Attributes:
        robot: which, from 0; as in all that follows.
        name: of the ground station, for people, within a sentence.
    """

    robot: int
    name: str


@dataclass(frozen=True, slots=True)
class ReleaseCommand:
    """The ground station that commands a robot gives it back to the participant."""

    robot: int


@dataclass(frozen=True, slots=True)
class SendFor:
    """The ground station that commands a robot sends it to a room, by the game's rules and with nobody's consent.

    Attributes:
        room: as people count, from 1.
    """

    robot: int
    room: int


@dataclass(frozen=True, slots=True)
class CallBackFor:
    """A robot that is under way in the game shall stop. Anybody may ask for that, whoever commands the robot."""

    robot: int


@dataclass(frozen=True, slots=True)
class PictureFor:
    """The ground station that commands a robot has a picture taken where it stands."""

    robot: int


@dataclass(frozen=True, slots=True)
class IdentifyFor:
    """The ground station that commands a robot names the treasure where it stands."""

    robot: int
    name: str


@dataclass(frozen=True, slots=True)
class LeaveFor:
    """The ground station that commands a robot gives up the treasure where it stands."""

    robot: int


@dataclass(frozen=True, slots=True)
class Pause:
    """Let no further tick come."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Let ticks come again."""


@dataclass(frozen=True, slots=True)
class SetRate:
    """Go on faster or slower.

    Attributes:
        rate: simulated seconds per second; 0: as fast as the machine can.
    """

    rate: float


@dataclass(frozen=True, slots=True)
class Step:
    """Let so many ticks come, and then no further one.

    Attributes:
        ticks: at least 1.
    """

    ticks: int = 1


PaceRequest = Pause | Resume | SetRate | Step
"""What may be asked of a session's pace. It acts at once, changes no result, and so is no input."""

WizardRequest = Puppeteer | SpeakFor | AdviseFor
"""What a person asks of the game who speaks in a robot's place; acts in the next tick."""

CommandRequest = TakeCommand | ReleaseCommand | SendFor | CallBackFor | PictureFor | IdentifyFor | LeaveFor
"""What is asked of the game in the name of a ground station; acts in the next tick. What the rules refuse is left."""

GameRequest = WizardRequest | CommandRequest
"""What is asked of the game, past the participant."""

RobotRequest = TeamInput | GraphRequest | SetParameters
"""Acts in the next tick. What is asked of a robot that is under way for the game delays its order, and no more."""

Request = RobotRequest | GameRequest
"""Whatever may be asked of a session."""


@dataclass(frozen=True, slots=True)
class Tuning:
    """All of one robot that may be changed while it runs.

    Attributes:
        software: its own.
        world: what is true of its body, motors and sensors.
    """

    software: RobotParameters
    world: WorldParameters

    def changed(self, values: Sequence[tuple[str, ParameterValue]]) -> "Tuning | ParameterRejection":
        """With all these values, or why one of them may not be; in whatever order they come."""
        true = [(path, value) for path, value in values if path.startswith(WORLD_PREFIX)]
        own = [(path, value) for path, value in values if not path.startswith(WORLD_PREFIX)]
        software, world = with_values(self.software, own), with_values(self.world, true)
        if isinstance(software, ParameterRejection):
            return software
        return world if isinstance(world, ParameterRejection) else Tuning(software, world)


def with_values(parameters: P, values: Sequence[tuple[str, ParameterValue]]) -> P | ParameterRejection:
    """The parameters with all these values, or why one of them may not be.

    In whatever order they come: a least that is above the greatest as it was waits for the greatest.
    """
    left = tuple(values)
    while left:
        waiting: list[tuple[str, ParameterValue]] = []
        rejected: list[ParameterRejection] = []
        for path, value in left:
            changed = reconfigured(parameters, path, value)
            if isinstance(changed, ParameterRejection):
                waiting.append((path, value))
                rejected.append(changed)
            else:
                parameters = changed
        if len(waiting) == len(left):
            return rejected[0]
        left = tuple(waiting)
    return parameters
