"""Tables of utterances in games, and of dialogue games."""

from collections.abc import Iterator
from dataclasses import dataclass

from sim.common.robot_numbers import number_of
from thbridge.analysis.report.dialogues import RecordedGame
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.families.attempts import Attempt, attempt_columns
from thbridge.experiment.export.families.described import (
    ExperimentTable,
    TableOf,
    count,
    flag,
    seconds,
    text,
    whole,
)
from thbridge.experiment.export.families.game_recording import GameRecording, RecordedTrial
from thbridge.experiment.progress import Run
from thbridge.ros.messages.session_records import DialogueMoveRecord, UtteranceRecord


@dataclass(frozen=True, slots=True)
class _SaidMove:
    """An utterance, or a move of a dialogue game that followed automatically."""

    run: Run
    attempt: Attempt
    time: float
    said: UtteranceRecord | DialogueMoveRecord
    move: DialogueMoveRecord | None
    waited: float | None
    waited_wall: float | None
    is_repeated: bool

    @property
    def talk(self) -> int:
        """Number of the dialogue."""
        return self.said.talk if isinstance(self.said, DialogueMoveRecord) else self.said.dialogue

    @property
    def locution(self) -> str:
        """Name of the move."""
        return self.said.locution if isinstance(self.said, DialogueMoveRecord) else self.said.move


def moves(design: ExperimentDesign, trial: RecordedTrial) -> ExperimentTable:
    """Return the rows of a trial's utterances and moves."""
    table: TableOf[_SaidMove] = TableOf(
        "moves",
        "a move in a dialogue of a trial",
        (
            *attempt_columns(design),
            seconds("time_s", "simulated time since the game began", lambda row: row.time),
            whole("talk", "number of the dialogue, from 1", lambda row: row.talk),
            whole(
                "robot",
                "number of the robot that speaks or is addressed, from 1",
                lambda row: number_of(row.said.robot),
                least=1,
            ),
            text("speaker", "robot or human", lambda row: row.said.speaker),
            text("author", "who decided on it: robot, person or wizard", lambda row: row.said.author),
            text(
                "matter",
                "select-room, take-picture or take-treasure; empty for moves that followed automatically",
                lambda row: row.said.scenario if isinstance(row.said, UtteranceRecord) else None,
            ),
            text("locution", "kind of move, such as ask, assert, challenge or continue", lambda row: row.locution),
            text(
                "game",
                "name of the dialogue game; empty outside of one",
                lambda row: None if row.move is None else row.move.game,
            ),
            whole(
                "game_number",
                "number of the dialogue game, from 1",
                lambda row: None if row.move is None else row.move.dialogue,
            ),
            text(
                "content",
                "what it is about, in a dialogue game",
                lambda row: None if row.move is None else row.move.content,
            ),
            flag(
                "booked",
                "whether it followed automatically from the move before it",
                lambda row: row.move is not None and row.move.is_booked,
            ),
            text(
                "text", "the sentence; empty for a move that followed automatically", lambda row: row.said.text or None
            ),
            count("words", "number of words in the sentence", lambda row: len(row.said.text.split())),
            flag(
                "misheard",
                "whether the robot misunderstood it as another move",
                lambda row: row.move is not None and bool(row.move.heard),
            ),
            flag(
                "repeated",
                "whether the person says the same again in the same dialogue, as in repeated questions",
                lambda row: row.is_repeated,
            ),
            seconds(
                "reply_s",
                "simulated time since the other side's last sentence in this dialogue; empty for a first one",
                lambda row: row.waited,
            ),
            seconds(
                "reply_wall_s",
                "reply_s in real time, as in decisions",
                lambda row: row.waited_wall,
            ),
        ),
    )
    return table.of(_said(trial, trial.recording))


def _said(trial: RecordedTrial, recording: GameRecording) -> Iterator[_SaidMove]:
    formal: dict[tuple[float, int, str, str], list[DialogueMoveRecord]] = {}
    booked: list[tuple[float, DialogueMoveRecord]] = []
    for time, move in ((each.time, each.move) for each in recording.moves):
        if move.is_booked:
            booked.append((time, move))
        else:
            formal.setdefault((time, move.talk, move.speaker, move.text), []).append(move)
    last: dict[tuple[int, str], float] = {}
    before: set[tuple[int, str, str]] = set()
    rows: list[_SaidMove] = []
    for time, said in ((each.time, each.said) for each in recording.utterances):
        waiting = formal.get((time, said.dialogue, said.speaker, said.text))
        other = last.get((said.dialogue, "robot" if said.speaker == "human" else "human"))
        key = (said.dialogue, said.speaker, said.text)
        rows.append(
            _SaidMove(
                trial.run,
                trial.attempt,
                time,
                said,
                waiting.pop(0) if waiting else None,
                None if other is None else time - other,
                None if other is None else trial.wall(other, time),
                said.speaker == "human" and bool(said.text) and key in before,
            )
        )
        before.add(key)
        last[said.dialogue, said.speaker] = time
    rows += (
        _SaidMove(trial.run, trial.attempt, time, move, move, None, None, is_repeated=False) for time, move in booked
    )
    yield from sorted(rows, key=lambda row: row.time)


@dataclass(frozen=True, slots=True)
class _DialogueGame:
    """A dialogue game of a trial."""

    run: Run
    attempt: Attempt
    played: RecordedGame


def dialogue_games(design: ExperimentDesign, trial: RecordedTrial) -> ExperimentTable:
    """Return the rows of a trial's dialogue games."""
    table: TableOf[_DialogueGame] = TableOf(
        "dialogue_games",
        "a dialogue game of robots that argue",
        (
            *attempt_columns(design),
            whole("robot", "number of the robot, from 1", lambda row: number_of(row.played.robot), least=1),
            whole("talk", "number of the dialogue that it belongs to", lambda row: row.played.talk),
            whole("game_number", "number from 1, unique for its robot", lambda row: row.played.number, least=1),
            count("parent", "number of the game that waits for it; 0: none", lambda row: row.played.parent),
            text("game", "name of the dialogue game, such as persuasion", lambda row: row.played.kind),
            text("topic", "what it is about", lambda row: row.played.topic),
            text("opener", "robot or human", lambda row: row.played.opener),
            text(
                "end",
                "such as agreement; unfinished: it was still open when the game ended",
                lambda row: row.played.end,
            ),
            count("moves", "number of moves, without those that followed automatically", lambda row: row.played.moves),
            count(
                "challenges",
                "depth: challenges in it and in the games that wait for it",
                lambda row: row.played.challenges,
            ),
            text(
                "gave_in",
                "side that finally accepted what it had opposed; empty: neither side",
                lambda row: row.played.gave_in or None,
            ),
            seconds("began_s", "simulated time of its first move since the game began", lambda row: row.played.began),
            seconds("ended_s", "simulated time of its last move since the game began", lambda row: row.played.ended),
            seconds(
                "replied_s",
                "time that the person took for their moves, without the first",
                lambda row: row.played.replied,
            ),
        ),
    )
    return table.of(_DialogueGame(trial.run, trial.attempt, played) for played in trial.recording.games)
