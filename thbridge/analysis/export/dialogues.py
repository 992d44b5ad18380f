"""Tables of argumentation dialogues: `dialogue_games`, and `dialogue_beliefs` with beliefs before and after moves."""

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import groupby

import numpy as np

from sim.common.robot_numbers import number_of
from thbridge.analysis.export.tables import SECONDS, Table, TableRows
from thbridge.analysis.report.dialogues import DialogueGatherer, RecordedGame
from thbridge.dialogue.portrait import DialoguePortrait, read_portrait
from thbridge.files.tables.table_files import Column, Values
from thbridge.ros.messages.session_records import DialogueMoveRecord, DialogueStateRecord
from thbridge.ros.messages.types import DIALOGUE_MOVE, DIALOGUE_STATE

_ROBOT = Column("robot", "int32", "", "number of the robot, from 1")
_TALK = Column("talk", "int64", "", "number of the dialogue of utterances, from 1")
GAMES = Table(
    "dialogue_games",
    "/dialogue/moves, /dialogue/states",
    "",
    "dialogue games of robots that argue; t_s is the time of the first move",
    (
        _ROBOT,
        SECONDS,
        _TALK,
        Column("dialogue", "int32", "", "number of the dialogue game, from 1, unique among the games of its robot"),
        Column("parent", "int32", "", "number of the game that is paused for this game; 0 if there is none"),
        Column("game_", "string", "", 'name of the game, for example "persuasion"'),
        Column("topic", "string", "", 'topic, for example "next(Robot1, Room3)"'),
        Column("opener", "string", "", '"robot" or "human"'),
        Column("end", "string", "", 'for example "agreement"; "unfinished" if the recording ended before the game'),
        Column("moves", "int32", "", "number of moves, without moves that follow automatically"),
        Column("challenges", "int32", "", "number of challenges in this game, and in games paused for this game"),
        Column(
            "gave_in",
            "string",
            "",
            "side that finally accepted a statement that it had opposed before; empty if neither side did",
        ),
        Column("until_s", "float64", "s", "time of the last move, since the beginning of the recording"),
        Column(
            "replied_s",
            "float64",
            "s",
            "time that the participant needed for all moves except the first move of the game",
        ),
    ),
)
BELIEFS = Table(
    "dialogue_beliefs",
    "/dialogue/moves, /dialogue/states",
    "",
    "beliefs of robots that argue, before and after moves of either side; t_s is the time of the moves",
    (
        _ROBOT,
        SECONDS,
        _TALK,
        Column("holder", "string", "", '"robot", or "human" for beliefs that the robot attributes to the participant'),
        Column("literal", "string", "", "the belief: a literal or a rule"),
        Column("source", "string", "", 'source of the belief; for beliefs of the participant, "held" or "unknown"'),
        Column("as_of_s", "float64", "s", "simulated time of the belief; nan if not reported"),
        Column("confidence", "float64", "", "confidence of the sensor or computation, 0 to 1; nan if not reported"),
        Column(
            "change",
            "string",
            "",
            '"kept", "gained" or "lost" by the moves; "first" after the first moves of a dialogue',
        ),
    ),
)
NAMES = (GAMES.name, BELIEFS.name)


class _Change(StrEnum):
    """Change of a belief by the moves of one tick."""

    KEPT = "kept"
    GAINED = "gained"
    LOST = "lost"
    FIRST = "first"
    """Evidence is evaluated again before each dialogue, so beliefs before its first move are not recorded."""


@dataclass(frozen=True, slots=True)
class _HeldBelief:
    """Belief in a state: holder, literal, source, time, confidence."""

    holder: str
    literal: str
    source: str
    at: float = np.nan
    confidence: float = np.nan


_Key = tuple[str, str, bool]
_Row = tuple[object, ...]


class DialogueTables:
    """Collector of moves and states of dialogues, from the rows of other tables."""

    def __init__(self) -> None:
        self._gatherers: defaultdict[int, DialogueGatherer] = defaultdict(DialogueGatherer)
        self._turns: dict[tuple[int, int, float], int] = {}
        self._states: dict[tuple[int, int, float], str] = {}

    def add(self, piece: TableRows) -> None:
        """Keep the moves or states in some rows of a table, if there are any."""
        if piece.table.msgtype not in {DIALOGUE_MOVE, DIALOGUE_STATE}:
            return
        columns = [column.name for column in piece.table.columns]
        for row in zip(*map(_listed, piece.values), strict=True):
            fields = dict(zip(columns, row, strict=True))
            game, time = int(str(fields.get("game", 0))), float(str(fields["t_s"]))
            if piece.table.msgtype == DIALOGUE_MOVE:
                move = _move(fields)
                self._gatherers[game].take_move(time, move)
                self._turns[game, move.robot, time] = move.talk
            else:
                self._take_state(
                    game, time, DialogueStateRecord(int(str(fields["talk"])), _robot(fields), str(fields["json"]))
                )

    def _take_state(self, game: int, time: float, state: DialogueStateRecord) -> None:
        try:
            self._gatherers[game].take_state(state)
        except ValueError:
            # States written by another version may be exported although they cannot be read here.
            return
        self._states[game, state.robot, time] = state.json

    def pieces(self) -> Iterator[TableRows]:
        """Yield the tables' rows, game by game; without moves there are no rows."""
        if self._turns:
            yield _rows(
                GAMES,
                [
                    _of_game(each)
                    for _, gatherer in sorted(self._gatherers.items())
                    for each in gatherer.dialogues().games
                ],
            )
        for _, turns in groupby(sorted(self._turns.items()), key=lambda turn: turn[0][:2]):
            yield _rows(BELIEFS, [*self._beliefs(dict(turns))])

    def _beliefs(self, turns: Mapping[tuple[int, int, float], int]) -> Iterator[_Row]:
        """Yield the rows of one robot's turns in one game of the hunt."""
        before, former = dict[_Key, _HeldBelief](), 0
        for key, talk in turns.items():
            state = self._states.get(key)
            after = before if state is None else _held(read_portrait(state))
            for each in {**before, **after} if talk == former else after:
                change = _Change.KEPT if each in before else _Change.GAINED
                if talk != former:
                    change = _Change.FIRST
                elif each not in after:
                    change = _Change.LOST
                belief = after.get(each) or before[each]
                fields = (belief.holder, belief.literal, belief.source, belief.at, belief.confidence)
                yield (key[1] + 1, key[2], talk, *fields, change.value)
            before, former = after, talk


def _held(portrait: DialoguePortrait) -> dict[_Key, _HeldBelief]:
    """Return the beliefs of a robot, and its beliefs about the participant."""
    held = [_HeldBelief("robot", each.literal, each.source, each.at, each.confidence) for each in portrait.sigma]
    held += [_HeldBelief("robot", rule, "rule") for rule in portrait.rules]
    held += [_HeldBelief("human", literal, "held") for literal in portrait.held]
    held += [_HeldBelief("human", proposition, "unknown") for proposition in portrait.unknown]
    return {(each.holder, each.literal, each.source == "unknown"): each for each in held}


def _of_game(game: RecordedGame) -> _Row:
    about = (game.kind, game.topic, game.opener, game.end, game.moves, game.challenges, game.gave_in)
    return (number_of(game.robot), game.began, game.talk, game.number, game.parent, *about, game.ended, game.replied)


def _move(fields: Mapping[str, object]) -> DialogueMoveRecord:
    number = {name: int(str(fields[name])) for name in ("talk", "dialogue", "parent", "index_")}
    text = {name: str(fields.get(name, "")) for name in _TEXTS}
    return DialogueMoveRecord(
        talk=number["talk"],
        dialogue=number["dialogue"],
        parent=number["parent"] or None,
        index=number["index_"],
        robot=_robot(fields),
        game=str(fields["game_"]),
        is_booked=bool(fields["booked"]),
        **text,
    )


_TEXTS = ("speaker", "author", "locution", "content", "before", "after", "text", "heard", "fault")


def _robot(fields: Mapping[str, object]) -> int:
    return int(str(fields["robot"])) - 1


def _listed(values: Values) -> list[object]:
    return [*values] if isinstance(values, list) else np.asarray(values).tolist()


def _rows(table: Table, rows: Sequence[_Row]) -> TableRows:
    columns = [*zip(*rows, strict=True)] if rows else [()] * len(table.columns)
    values = (
        [str(value) for value in held] if column.kind == "string" else np.array(held, dtype=column.kind)
        for column, held in zip(table.columns, columns, strict=True)
    )
    return TableRows(table, len(rows), tuple(values))
