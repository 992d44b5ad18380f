"""The table `dyads` of games of several people: what one seat did toward another one."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise, permutations
from statistics import fmean

from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.families.described import ExperimentTable, TableOf, ValuedColumn, count, seconds, text
from thbridge.experiment.export.families.game_recording import TimedEvent
from thbridge.experiment.export.families.group_games import RecordedGroup, objections_in, turns_in
from thbridge.experiment.export.families.group_tables import GroupedRow, game_columns, joint_decisions_in, texts_in
from thbridge.hunt.events import Commander, CommanderChanged

Pair = tuple[str, str]
"""A seat that does something, and the seat toward which it does it."""


@dataclass(slots=True)
class _Acts:
    """Acts of seats toward each other; texts, reads and votes have a time in seconds each."""

    texts: Counter[Pair] = field(default_factory=Counter)
    reads: dict[Pair, list[float]] = field(default_factory=dict)
    votes: dict[Pair, list[float]] = field(default_factory=dict)
    agreed: Counter[Pair] = field(default_factory=Counter)
    objections: Counter[Pair] = field(default_factory=Counter)
    handed_over: Counter[Pair] = field(default_factory=Counter)
    turns: Counter[Pair] = field(default_factory=Counter)


@dataclass(frozen=True, slots=True)
class _Dyad(GroupedRow):
    pair: Pair
    acts: _Acts


def dyads(design: ExperimentDesign, game: RecordedGroup) -> ExperimentTable:
    """Return the rows of all ordered pairs of seats of a game."""

    def counted(name: str, meaning: str) -> ValuedColumn[_Dyad]:
        def number_of_acts(row: _Dyad) -> int | None:
            found: Counter[Pair] = getattr(row.acts, name)
            return None if row.group.recording is None else found[row.pair]

        return count(name, meaning, number_of_acts)

    def mean(name: str, meaning: str, times: str) -> ValuedColumn[_Dyad]:
        def mean_time(row: _Dyad) -> float | None:
            found: dict[Pair, list[float]] = getattr(row.acts, times)
            return fmean(found[row.pair]) if row.pair in found else None

        return seconds(name, meaning, mean_time)

    def voted(row: _Dyad) -> int | None:
        return None if row.group.recording is None else len(row.acts.votes.get(row.pair, ()))

    table: TableOf[_Dyad] = TableOf(
        "dyads",
        "an ordered pair of seats of a game: what one seat did toward the other",
        (
            *game_columns(design),
            text("seat", "name of the seat that acts", lambda row: row.pair[0]),
            text("participant", "id of the person who took this seat at the start", lambda row: _person(row, 0)),
            text("toward", "name of the other seat", lambda row: row.pair[1]),
            text("toward_participant", "id of the person who took the other seat", lambda row: _person(row, 1)),
            counted("texts", "number of texts of the seat that the other seat could read"),
            mean("read_after_s", "mean time from the seat's texts until the other seat read them", "reads"),
            count("votes", "number of votes of the seat on decisions that the other seat proposed", voted),
            counted("agreed", "number of these votes that agree"),
            mean("vote_after_s", "mean time from the other seat's proposal to the seat's vote", "votes"),
            counted("objections", "number of objections of the seat in dialogues of the other seat"),
            counted("handed_over", "number of times that the seat handed over a robot to the other seat"),
            counted("turns", "number of turns of the seat right after a turn of the other seat"),
        ),
    )
    acts = _acts(game)
    return table.of(_Dyad(game, pair, acts) for pair in permutations(game.game.began, 2))


def _person(row: _Dyad, index: int) -> str | None:
    return row.group.participant(row.pair[index])


def _acts(game: RecordedGroup) -> _Acts:
    found = _Acts()
    for each in texts_in(game):
        pair = (each.said.seat, each.reader)
        found.texts[pair] += 1
        if each.read is not None:
            found.reads.setdefault(pair, []).append(max(0.0, each.read - each.time))
    for made in joint_decisions_in(game):
        for vote in made.votes:
            if vote.seat != made.proposed.seat:
                pair = (vote.seat, made.proposed.seat)
                found.votes.setdefault(pair, []).append(vote.time - made.time)
                found.agreed[pair] += vote.agrees
    if game.recording is not None:
        found.objections.update((each.raised.seat, each.decider) for each in objections_in(game.recording))
        found.handed_over.update(_handed_over(game.recording.happenings))
        found.turns.update((seat, before) for before, seat in pairwise(turns_in(game.recording)))
    return found


def _handed_over(happenings: Sequence[object]) -> list[Pair]:
    """Return the giver and the receiver each time that a seat handed over a robot to another seat."""
    return [
        (event.seat, event.name)
        for each in happenings
        if isinstance(each, TimedEvent)
        and isinstance(event := each.event, CommanderChanged)
        and event.by is Commander.PARTICIPANT
        and event.seat
        and event.name != event.seat
    ]
