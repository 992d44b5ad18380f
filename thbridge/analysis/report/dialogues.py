"""Argumentation dialogues in a recording: games, ends, moves, and which side gave in."""

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

from thbridge.dialogue.games.tables import DialogueEnd
from thbridge.dialogue.portrait import read_portrait
from thbridge.ros.messages.session_records import DialogueMoveRecord, DialogueStateRecord, UtteranceRecord

ENDS = (*DialogueEnd, "unfinished")
"""Ends of dialogue games in recordings; "unfinished" if the recording ended first or the game was dropped."""
_HOLDS_OUT = frozenset({"challenge", "reject"})
"""Locutions that express disagreement."""


@dataclass(frozen=True, slots=True)
class RecordedGame:
    """Dialogue game in a recording.

    Attributes:
        robot: index of the robot.
        number: number of the game, unique among the games of its robot.
        kind: name of the game.
        opener: "robot" or "human".
        end: one of `ENDS`.
        moves: number of its moves, without moves that follow automatically.
        challenges: number of challenges in this game, and in games that are paused for this game.
        gave_in: "robot" or "human": the side that finally accepted a statement that it had challenged, rejected or
            denied before, in the same situation; empty if neither side did.
        talk: number of the dialogue (of utterances) that contains this game.
        parent: number of the game that is paused for this game; 0 if there is none.
        topic: topic of the game.
        began: time of its first move, s.
        ended: time of its last move, s.
        replied: time that the participant needed for moves after the first; each is timed from the previous move, s.
    """

    robot: int
    number: int
    kind: str
    opener: str
    end: str
    moves: int
    challenges: int
    gave_in: str
    talk: int
    parent: int
    topic: str
    began: float
    ended: float
    replied: float


@dataclass(frozen=True, slots=True)
class RecordedDialogues:
    """Argumentation dialogues in a recording.

    Attributes:
        games: all dialogue games, robot by robot.
        moves: number of moves by speaker and locution, without moves that follow automatically.
        questions: number of questions that the participant asked outside these games.
        overrides: number of decisions against a robot's advice.
        misheard: number of moves that a robot mistook for other moves.
        strategy_faults: number of moves that a robot chose with its own strategy, because the study's strategy failed.
    """

    games: tuple[RecordedGame, ...] = ()
    moves: dict[tuple[str, str], int] = field(default_factory=dict)
    questions: int = 0
    overrides: int = 0
    misheard: int = 0
    strategy_faults: int = 0


class DialogueGatherer:
    """Collector of dialogues from their recorded messages, in the order of time."""

    def __init__(self) -> None:
        self._courses: defaultdict[tuple[int, int], list[DialogueMoveRecord]] = defaultdict(list)
        self._times: defaultdict[tuple[int, int], list[float]] = defaultdict(list)
        self._ends: dict[tuple[int, int], str] = {}
        self._begins: dict[tuple[int, int], int] = {}
        self._words: Counter[str] = Counter()

    def take_utterance(self, utterance: UtteranceRecord) -> None:
        """Add an utterance."""
        self._words[utterance.move] += 1

    def take_move(self, time: float, move: DialogueMoveRecord) -> None:
        """Add a move of a dialogue game, with its time, s."""
        self._courses[move.robot, move.dialogue].append(move)
        self._times[move.robot, move.dialogue].append(time)

    def take_state(self, state: DialogueStateRecord) -> None:
        """Add a robot's state of a dialogue. Raise ValueError if the state cannot be read."""
        games = read_portrait(state.json).games
        for game in games:
            self._ends[state.robot, game.number] = game.end
            self._begins[state.robot, game.number] = games[0].number

    def dialogues(self) -> RecordedDialogues:
        """Return the collected dialogues."""
        said = [move for course in self._courses.values() for move in course if not move.is_booked]
        return RecordedDialogues(
            games=tuple(self._game(*key) for key in sorted(self._courses)),
            moves=dict(sorted(Counter((move.speaker, move.locution) for move in said).items())),
            questions=self._words["enquire"],
            overrides=self._words["override"],
            misheard=sum(bool(move.heard) for move in said),
            strategy_faults=sum(bool(move.fault) for move in said),
        )

    def _game(self, robot: int, number: int) -> RecordedGame:
        course, times = self._courses[robot, number], self._times[robot, number]
        first, last = course[0], course[-1]
        ending = last.after if last.after in ENDS else self._ends.get((robot, number), "")
        return RecordedGame(
            robot=robot,
            number=number,
            kind=last.game,
            opener=first.speaker,
            end=ending if ending in ENDS else "unfinished",
            moves=sum(not move.is_booked for move in course),
            challenges=sum(move.locution == "challenge" for move in self._with_outer(course)),
            gave_in=last.speaker if ending == DialogueEnd.AGREEMENT and self._held_out(last) else "",
            talk=first.talk,
            parent=first.parent or 0,
            topic=first.content,
            began=times[0],
            ended=times[-1],
            replied=sum(
                now - before
                for move, (before, now) in zip(course[1:], pairwise(times), strict=True)
                if move.speaker == "human" and not move.is_booked
            ),
        )

    def _with_outer(self, course: list[DialogueMoveRecord]) -> Iterator[DialogueMoveRecord]:
        """Yield the moves of a game and of the games that are paused for it. Only later games can pause a game."""
        yield from course
        robot, number, parent = course[0].robot, course[0].dialogue, course[0].parent
        if parent is not None and parent < number and (robot, parent) in self._courses:
            yield from self._with_outer(self._courses[robot, parent])

    def _held_out(self, accepted: DialogueMoveRecord) -> bool:
        """Return True if the accepting side earlier denied or did not accept the statement, in the same situation."""
        begin = self._begins.get((accepted.robot, accepted.dialogue), accepted.dialogue)
        before = (
            move
            for (robot, number), course in self._courses.items()
            if robot == accepted.robot and begin <= number <= accepted.dialogue
            for move in course
            if move.speaker == accepted.speaker
        )
        same = {accepted.content, _opposite(accepted.content)}
        return any(
            (move.locution in _HOLDS_OUT and move.content in same) or move.content == _opposite(accepted.content)
            for move in before
        )


def count_ends(games: Iterable[RecordedGame]) -> dict[str, int]:
    """Return the number of games by end, in the order of `ENDS`; ends that did not occur are omitted."""
    counts = Counter(game.end for game in games)
    return {str(end): counts[end] for end in ENDS if counts[end]}


def _opposite(content: str) -> str:
    return content.removeprefix("not ") if content.startswith("not ") else f"not {content}"
