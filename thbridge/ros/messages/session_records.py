"""Records of a session and its game, as our own message types hold them."""

from dataclasses import dataclass

MACHINE = ("architecture", "libc", "processor", "processor features", "compiler target", "compiler features")
"""Names in `SessionRecord.versions` that tell of the machine."""


@dataclass(frozen=True, slots=True)
class SessionRecord:
    """All that is needed to run a session again; the first record of its bag.

    Attributes:
        study: the resolved study file, YAML.
        seed: seed of all random numbers; 0 to 2^64 - 1.
        versions: versions of the programs and libraries by name, and the machine, by the names in `MACHINE`; older
            recordings tell nothing of it.
        program: the program that was run: "play", or "simr" by itself at a server of another process.
        roles: the roles that ran inside it, besides the keeper.
        participant: the participant inside it, for example "person" or "suggestion"; empty when there was none.
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
    """Score, rooms and energy of a game; recorded whenever one of them changes.

    Attributes:
        score: points so far.
        visited: rooms visited.
        rooms: rooms there are.
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
        move: the dialogue move that it makes, for example "continue".
        author: who chose it: "robot" (its strategy), "person", or "wizard" (a person in the robot's place).
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
    """One move in a dialogue game, where robots argue.

    Attributes:
        talk: number of the dialogue of utterances that it belongs to.
        dialogue: number of the dialogue game, from 1, unique among those of its robot.
        parent: number of the game that waits for this one, or None.
        index: place of the move in its game, from 0.
        robot: the robot that speaks or is addressed.
        speaker: "robot" or "human".
        author: as in `UtteranceRecord`.
        game: name of the game, for example "persuasion".
        locution: for example "challenge".
        content: what it is about, written as in Sklar and Azhar (2015).
        before: state of the game in which it was made.
        after: state, or end, that followed.
        is_booked: True when it followed by itself from the move before it.
        text: the sentence; empty for a move that followed by itself.
        heard: sentence of the move that the robot took it for; empty where it heard right.
        fault: why the robot's own strategy chose it, the study's having failed; empty where that did not fail.
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
    """Beliefs and arguments of a robot that argues; recorded whenever they change.

    Attributes:
        talk: number of the dialogue of utterances.
        robot: the robot.
        json: portrait of its conversation with the participant.
    """

    talk: int
    robot: int
    json: str


@dataclass(frozen=True, slots=True)
class HeldTurns:
    """Robots' turns that wait for the wizard, a person in their place; recorded whenever they change.

    Attributes:
        json: all waiting turns.
    """

    json: str


@dataclass(frozen=True, slots=True)
class InputRecord:
    """An input that came into a session from outside, exactly as it came; recorded before its effects.

    Attributes:
        kind: one word, for example "received" or "asked".
        sender: the program, connection or window it came from; empty for the clock.
        line: the input as one line for people.
        json: the whole input.
    """

    kind: str
    sender: str
    line: str
    json: str
