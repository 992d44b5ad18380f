"""Records of a session and its game, as in thbridge's own message types."""

from dataclasses import dataclass

MACHINE = ("architecture", "libc", "processor", "processor features", "compiler target", "compiler features")
"""Names in `SessionRecord.versions` that describe the machine."""


@dataclass(frozen=True, slots=True)
class SessionRecord:
    """Everything needed to run a session again; the first record of its bag.

    Attributes:
        study: the resolved study file, YAML.
        seed: random seed, 0 to 2^64 - 1.
        versions: versions of programs and libraries by name, and properties of the machine by the names in `MACHINE`;
            older recordings have no properties of the machine.
        program: the program that was run: "play", or "simr" at a server of another process.
        roles: roles that ran inside it, in addition to the keeper.
        participant: the participant inside it, for example "person" or "suggestion"; empty if there was none.
    """

    study: str
    seed: int
    versions: dict[str, str]
    program: str
    roles: tuple[str, ...]
    participant: str


@dataclass(frozen=True, slots=True)
class GameEvent:
    """An event of the game.

    Attributes:
        kind: one word, for example "arrived".
        robot: the robot it concerns, or None.
        room: the room it concerns, or None.
        json: the whole event.
    """

    kind: str
    robot: int | None
    room: int | None
    json: str


@dataclass(frozen=True, slots=True)
class ScoreRecord:
    """Score, rooms and energy of a game; recorded at every change.

    Attributes:
        score: points so far.
        visited: number of rooms visited.
        rooms: number of rooms.
        energy: the energy left of each robot, in the game's units.
    """

    score: int
    visited: int
    rooms: int
    energy: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class UtteranceRecord:
    """One utterance of a dialogue.

    Attributes:
        dialogue: number of the dialogue.
        speaker: "robot" or "human".
        robot: the robot that speaks or is addressed.
        room: the room it is about, or None.
        scenario: for example "select-room".
        text: the sentence.
        move: the dialogue move that the sentence makes, for example "continue".
        author: who chose it: "robot" (its strategy), "person", or "wizard" (a person who speaks for the robot).
    """

    dialogue: int
    speaker: str
    robot: int
    room: int | None
    scenario: str
    text: str
    move: str
    author: str


@dataclass(frozen=True, slots=True)
class DialogueMoveRecord:
    """One move in a dialogue game, in sessions where robots argue.

    Attributes:
        talk: number of the dialogue of utterances that it belongs to.
        dialogue: number of the dialogue game, from 1, unique among those of its robot.
        parent: number of the game that waits for this one, or None.
        index: position of the move in its game, from 0.
        robot: the robot that speaks or is addressed.
        speaker: "robot" or "human".
        author: as in `UtteranceRecord`.
        game: name of the game, for example "persuasion".
        locution: for example "challenge".
        content: what it is about, written as in Sklar and Azhar (2015).
        before: state of the game in which it was made.
        after: state, or end, after it.
        is_booked: True if it followed automatically from the move before it.
        text: the sentence; empty for a move that followed automatically.
        heard: sentence of the move that the robot understood instead; empty if the robot understood the move correctly.
        fault: why the robot's own strategy chose the move after the study's strategy failed; empty if it did not fail.
    """

    talk: int
    dialogue: int
    parent: int | None
    index: int
    robot: int
    speaker: str
    author: str
    game: str
    locution: str
    content: str
    before: str
    after: str
    is_booked: bool
    text: str
    heard: str
    fault: str = ""


@dataclass(frozen=True, slots=True)
class DialogueStateRecord:
    """Beliefs and arguments of a robot that argues; recorded at every change.

    Attributes:
        talk: number of the dialogue of utterances.
        robot: the robot.
        json: JSON object that describes its conversation with the participant.
    """

    talk: int
    robot: int
    json: str


@dataclass(frozen=True, slots=True)
class HeldTurns:
    """Robots' turns that wait for the wizard, a person who speaks for them; recorded at every change.

    Attributes:
        json: all waiting turns.
    """

    json: str


@dataclass(frozen=True, slots=True)
class InputRecord:
    """An input that a session received from outside, unchanged; recorded before its effects.

    Attributes:
        kind: one word, for example "received" or "asked".
        sender: program, connection or window that sent it; empty for the clock.
        line: the input as one line for people.
        json: the whole input.
    """

    kind: str
    sender: str
    line: str
    json: str
