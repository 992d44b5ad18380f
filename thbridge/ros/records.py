"""What goes into a bag besides the robots' own topics: the session, the game, the talk, and what people did.

Robots are indices of the team, from 0; rooms are numbers as people say them, 0 the corridor. In the messages robots
count from 1, as their namespaces do.
"""

from dataclasses import dataclass

from sim.geometry import FloatArray, Pose2


@dataclass(frozen=True, slots=True)
class Session:
    """What is needed to run the session again; the first record of its bag.

    Attributes:
        study: the resolved study file, YAML.
        seed: of every chance; 0 to 2^64 - 1.
        versions: of the programs and libraries, by name.
        program: that was run: "play", or "simr" by itself at a server of another process.
        roles: that ran inside it, besides the keeper.
        participant: who played inside it, for example "person" or "suggestion"; empty when nobody did.
    """

    study: str
    seed: int
    versions: dict[str, str]
    program: str
    roles: tuple[str, ...]
    participant: str


@dataclass(frozen=True, slots=True)
class GameEvent:
    """Something happened in the game.

    Attributes:
        kind: one word, for example "arrived".
        robot: whom it concerns, or None.
        room: the room it concerns, or None.
        json: all of it.
    """

    kind: str
    robot: int | None
    room: int | None
    json: str


@dataclass(frozen=True, slots=True)
class Score:
    """How the game stands; recorded whenever that changes.

    Attributes:
        score: points so far.
        visited: rooms visited.
        rooms: rooms there are.
        energy: what each robot has left, in the game's units.
    """

    score: int
    visited: int
    rooms: int
    energy: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Utterance:
    """One thing said in a dialogue.

    Attributes:
        dialogue: number of the dialogue.
        speaker: "robot" or "human".
        robot: the robot that talks or is talked to.
        room: what room it is about, or None.
        scenario: for example "select-room".
        text: the sentence.
        move: the move it stands for, for example "continue".
    """

    dialogue: int
    speaker: str
    robot: int
    room: int | None
    scenario: str
    text: str
    move: str


@dataclass(frozen=True, slots=True)
class Input:
    """Something that came into a session from outside, exactly as it came; said before what follows from it.

    Attributes:
        kind: one word, for example "received" or "asked".
        sender: the program, connection or window it came from; empty for the clock.
        line: what it was, for people.
        json: all of it.
    """

    kind: str
    sender: str
    line: str
    json: str


@dataclass(frozen=True, slots=True)
class SendRobots:
    """A raw %%goto line, on the topic that the system of 2016 had for it."""

    line: str


@dataclass(frozen=True, slots=True)
class Success:
    """A raw %%error line, on the topic that the system of 2016 had for it."""

    line: str


@dataclass(frozen=True, slots=True, eq=False)
class InitialPose:
    """A person told a robot where it is.

    Attributes:
        robot: which.
        base_in_map: where.
        covariance: (3, 3) of x, y, theta in the map frame.
    """

    robot: int
    base_in_map: Pose2
    covariance: FloatArray


Record = GameEvent | Score | Utterance | Input | SendRobots | Success | InitialPose
