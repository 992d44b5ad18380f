"""Records of a session and its game, with the fields of thbridge's own message types."""

from dataclasses import dataclass

MACHINE = ("architecture", "libc", "processor", "processor features", "compiler target", "compiler features")
"""Names in `SessionRecord.versions` that describe the machine."""


@dataclass(frozen=True, slots=True)
class SessionRecord:
    """All data that are needed to run a session again. It is the first record of its bag.

    Attributes:
        study: the resolved study file as YAML.
        seed: random seed, 0 to 2^64 - 1.
        versions: versions of programs and libraries by name, and properties of the machine by the names in `MACHINE`.
            Older recordings have no properties of the machine.
        program: name of the program: "play", or "simr" if the server was another process.
        roles: roles that ran in this program, in addition to the keeper.
        participant: the participant in this program, for example "person" or "suggestion". Empty if there was none.
    """

    study: str
    seed: int
    versions: dict[str, str]
    program: str
    roles: tuple[str, ...]
    participant: str


@dataclass(frozen=True, slots=True)
class GameEvent:
    """Event of the game.

    Attributes:
        kind: one word, for example "arrived".
        robot: robot of the event, or None.
        room: room of the event, or None.
        json: the complete event as JSON.
    """

    kind: str
    robot: int | None
    room: int | None
    json: str


@dataclass(frozen=True, slots=True)
class TeamEvent:
    """Text or vote of a participant, in a game with several seats; `event` has it as an event of a journal."""

    event: GameEvent


@dataclass(frozen=True, slots=True)
class SeatNotice:
    """Notice that the participant's program of a seat received, in a game with several seats.

    Attributes:
        seat: name of the seat.
        kind: kind of the notice: "View" for what the participant sees of the game, "Talk" for texts.
        json: the complete notice as JSON.
    """

    seat: str
    kind: str
    json: str


@dataclass(frozen=True, slots=True)
class ScoreRecord:
    """Score, rooms and energy of a game. It is recorded at every change.

    Attributes:
        score: points so far.
        visited: number of visited rooms.
        rooms: number of rooms.
        energy: remaining energy of each robot, in the game's units.
    """

    score: int
    visited: int
    rooms: int
    energy: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class UtteranceRecord:
    """Utterance of a dialogue.

    Attributes:
        dialogue: number of the dialogue.
        speaker: "robot" or "human".
        robot: the robot that speaks, or to which the participant speaks.
        room: room that the utterance is about, or None.
        scenario: scenario of the dialogue, for example "select-room".
        text: the sentence.
        move: dialogue move of the sentence, for example "continue".
        author: party that chose the sentence: "robot" (its strategy), "person", or "wizard" (a researcher who speaks
            for the robot). In a game with several seats, the party in a seat is followed by the seat, for example
            "person driver", or "wizard driver" if a researcher plays the seat.
    """

    dialogue: int
    speaker: str
    robot: int
    room: int | None
    scenario: str
    text: str
    move: str
    author: str

    @property
    def seat(self) -> str:
        """Seat of the participant who chose the sentence; empty for robots, and in games with one participant."""
        return self.author.partition(" ")[2]

    @property
    def is_by_wizard(self) -> bool:
        """True if a researcher chose the sentence in the place of a robot or of a participant."""
        return self.author.partition(" ")[0] == "wizard"


@dataclass(frozen=True, slots=True)
class DialogueMoveRecord:
    """Move in a dialogue game, in sessions where robots argue.

    Attributes:
        talk: number of the dialogue of utterances that contains it.
        dialogue: number of the dialogue game, from 1. It is unique among the dialogue games of its robot.
        parent: number of the game that waits for the end of this game, or None.
        index: position of the move in its game, from 0.
        robot: the robot that speaks, or to which the participant speaks.
        speaker: "robot" or "human".
        author: see `UtteranceRecord`.
        game: name of the game, for example "persuasion".
        locution: type of the move, for example "challenge".
        content: content of the move, in the notation of Sklar and Azhar (2015).
        before: state of the game before the move.
        after: state or end of the game after the move.
        is_booked: True if it followed automatically from the previous move.
        text: the sentence. Empty for a move that followed automatically.
        heard: sentence of the move that the robot understood instead. Empty if it understood the move correctly.
        fault: failure of the study's strategy, after which the robot's own strategy chose the move. Empty if nothing
            failed.
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
    """Beliefs and arguments of a robot that argues. It is recorded at every change.

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
    """Robots' turns that wait for the wizard, a person who speaks for the robots. It is recorded at every change.

    Attributes:
        json: all waiting turns as JSON.
    """

    json: str


@dataclass(frozen=True, slots=True)
class InputRecord:
    """Unchanged input that a session received from outside. It is recorded before its effects.

    Attributes:
        kind: one word, for example "received" or "asked".
        sender: program, connection or window that sent it. Empty for the clock.
        line: description of the input for people, in one line.
        json: the complete input as JSON.
    """

    kind: str
    sender: str
    line: str
    json: str
