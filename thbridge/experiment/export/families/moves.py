"""The tables `moves` and `dialogue_games`: utterances and dialogue games in trials."""

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
    """An utterance, or an automatic move of a dialogue game."""

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
            seconds("time_s", "simulated time since the start of the game", lambda row: row.time),
            whole("talk", "number of the dialogue, from 1", lambda row: row.talk),
            whole(
                "robot",
                "number of the robot in this dialogue, from 1",
                lambda row: number_of(row.said.robot),
                least=1,
            ),
            text("speaker", "robot or human", lambda row: row.said.speaker),
            text("author", "decision maker for this move: robot, person or wizard", lambda row: row.said.author),
            text(
                "matter",
                "subject of the dialogue: select-room, take-picture or take-treasure; empty for automatic moves",
                lambda row: row.said.scenario if isinstance(row.said, UtteranceRecord) else None,
            ),
            text("locution", "kind of the move, such as ask, assert, challenge or continue", lambda row: row.locution),
            text(
                "game",
                "name of the dialogue game; empty outside of dialogue games",
                lambda row: None if row.move is None else row.move.game,
            ),
            whole(
                "game_number",
                "number of the dialogue game, from 1",
                lambda row: None if row.move is None else row.move.dialogue,
            ),
            text(
                "content",
                "content of the move in a dialogue game",
                lambda row: None if row.move is None else row.move.content,
            ),
            flag(
                "booked",
                "true for an automatic move, which follows from the move before",
                lambda row: row.move is not None and row.move.is_booked,
            ),
            text("text", "the sentence; empty for automatic moves", lambda row: row.said.text or None),
            count("words", "number of words in the sentence", lambda row: len(row.said.text.split())),
            flag(
                "misheard",
                "true if the robot misunderstood this move as another move",
                lambda row: row.move is not None and bool(row.move.heard),
            ),
            flag(
                "repeated",
                "true if the person already said the same sentence in this dialogue",
                lambda row: row.is_repeated,
            ),
            seconds(
                "reply_s",
                "simulated time since the last sentence of the other speaker in this dialogue; empty if there is none",
                lambda row: row.waited,
            ),
            seconds(
                "reply_wall_s",
                "reply_s in real time; accuracy and empty values as for shown_wall_s in the table decisions",
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
            whole("talk", "number of the dialogue", lambda row: row.played.talk),
            whole(
                "game_number",
                "number of the dialogue game, from 1, unique for each robot",
                lambda row: row.played.number,
                least=1,
            ),
            count(
                "parent",
                "number of the dialogue game that waits for this game; 0 if there is none",
                lambda row: row.played.parent,
            ),
            text("game", "name of the dialogue game, such as persuasion", lambda row: row.played.kind),
            text("topic", "topic of the dialogue game", lambda row: row.played.topic),
            text("opener", "side that opened the dialogue game: robot or human", lambda row: row.played.opener),
            text(
                "end",
                "result, such as agreement; unfinished: the dialogue game was open at the end of the hunt",
                lambda row: row.played.end,
            ),
            count("moves", "number of moves without automatic moves", lambda row: row.played.moves),
            count(
                "challenges",
                "depth: number of challenges in this dialogue game and in the games that wait for it",
                lambda row: row.played.challenges,
            ),
            text(
                "gave_in",
                "side that finally accepted a claim that it had opposed: robot or human; empty if there is none",
                lambda row: row.played.gave_in or None,
            ),
            seconds(
                "began_s", "simulated time from the start of the hunt to the first move", lambda row: row.played.began
            ),
            seconds(
                "ended_s", "simulated time from the start of the hunt to the last move", lambda row: row.played.ended
            ),
            seconds(
                "replied_s",
                "total time that the person needed for their moves, except the first move",
                lambda row: row.played.replied,
            ),
        ),
    )
    return table.of(_DialogueGame(trial.run, trial.attempt, played) for played in trial.recording.games)
