"""The tables of games of several people: `groups`, `seats`, `texts`, `joint_decisions`, `votes` and `objections`."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import TypeVar

from sim.common.robot_numbers import number_of
from thbridge.experiment.design.experiment_file import ExperimentDesign
from thbridge.experiment.export.families.attempts import OfAttempt, attempt_columns
from thbridge.experiment.export.families.described import (
    ExperimentTable,
    TableOf,
    ValuedColumn,
    count,
    flag,
    number,
    seconds,
    share,
    text,
    whole,
)
from thbridge.experiment.export.families.group_games import (
    AnsweredObjection,
    RecordedGroup,
    SeatActs,
    objections_in,
    subject_of,
)
from thbridge.experiment.lobby import SeatHolder
from thbridge.experiment.store.events import EventKind
from thbridge.hunt.events import (
    DecisionOutcome,
    DecisionProposed,
    DecisionSettled,
    ObjectionReason,
    PersonRead,
    PersonSaid,
    VoteCast,
)

_OF_A_PERSON = {"participant", "counts", "group", "seat", "attempt"}
"""Columns of attempts that differ between the people of a group."""


@dataclass(frozen=True, slots=True)
class GroupedRow:
    """Object of a row that belongs to a game of a group; tables have their own classes of it."""

    group: RecordedGroup


@dataclass(frozen=True, slots=True)
class _Seat(GroupedRow):
    seat: str
    acts: SeatActs


@dataclass(frozen=True, slots=True)
class _Text(GroupedRow):
    time: float
    said: PersonSaid
    reader: str
    read: float | None

    def author_seat(self) -> str:
        return self.said.seat

    def reader_seat(self) -> str:
        return self.reader

    def sent(self) -> float:
        return self.time


@dataclass(slots=True)
class _Vote:
    seat: str
    agrees: bool
    reason: str
    time: float


@dataclass(slots=True)
class _Decision:
    time: float
    proposed: DecisionProposed
    votes: list[_Vote] = field(default_factory=list)
    settled: float | None = None
    outcome: str | None = None


@dataclass(frozen=True, slots=True)
class _DecisionRow(GroupedRow):
    made: _Decision

    def proposer(self) -> str:
        return self.made.proposed.seat

    def began(self) -> float:
        return self.made.time


@dataclass(frozen=True, slots=True)
class _VoteRow(_DecisionRow):
    vote: _Vote

    def voter(self) -> str:
        return self.vote.seat

    def voted(self) -> float:
        return self.vote.time


@dataclass(frozen=True, slots=True)
class _Objection(GroupedRow):
    answered: AnsweredObjection

    def objector(self) -> str:
        return self.answered.raised.seat

    def raised(self) -> float:
        return self.answered.time


G = TypeVar("G", bound=GroupedRow)


def groups(design: ExperimentDesign, game: RecordedGroup) -> ExperimentTable:
    """Return the row of a game of a group."""

    def holders(row: RecordedGroup, holder: SeatHolder) -> int:
        return [*row.game.began.values()].count(holder)

    def logged_number(row: RecordedGroup, name: str) -> float | None:
        return None if (value := row.logged(name)) is None else float(value)

    def whole_number(row: RecordedGroup, name: str) -> int | None:
        return None if (value := row.logged(name)) is None else int(value)

    def in_game(row: GroupedRow, value: int) -> int | None:
        return None if row.group.recording is None else value

    table: TableOf[GroupedRow] = TableOf(
        "groups",
        "a game of a group of people",
        (
            *game_columns(design),
            text("seats", "names of the seats", lambda row: "; ".join(row.group.game.began)),
            count("people", "number of seats that people had at the start", lambda row: holders(row.group, _PERSON)),
            count(
                "programs", "number of seats that programs had at the start", lambda row: holders(row.group, _PROGRAM)
            ),
            count(
                "empty_seats", "number of seats that were empty at the start", lambda row: holders(row.group, _EMPTY)
            ),
            flag(
                "incomplete",
                "true if a seat was empty or was taken by a program at any time of the game",
                lambda row: row.group.game.incomplete,
            ),
            seconds(
                "most_waited_s",
                "longest time for which a person of the group waited in the lobby",
                lambda row: max(row.group.waited.values(), default=None),
            ),
            whole("score", "points at the end", lambda row: whole_number(row.group, "score")),
            text(
                "over",
                "reason for the end of the game: all-visited, no-move-left or given-up; empty for the time limit, and "
                "for games that ended because a person left",
                lambda row: row.group.logged("over"),
            ),
            count(
                "rooms_visited",
                "number of rooms that robots reached",
                lambda row: whole_number(row.group, "rooms_visited"),
            ),
            count(
                "identified",
                "number of treasures named, rightly or wrongly",
                lambda row: whole_number(row.group, "identified"),
            ),
            seconds(
                "sim_seconds",
                "simulated time from the start to the end of the game",
                lambda row: logged_number(row.group, "sim_seconds"),
            ),
            number(
                "energy_left",
                "",
                "total remaining energy of all robots, game units",
                lambda row: logged_number(row.group, "energy_left"),
            ),
            count("texts", "number of texts between people", lambda row: in_game(row, row.group.acts.texts)),
            count(
                "proposed",
                "number of decisions on which people voted",
                lambda row: in_game(row, row.group.acts.proposed),
            ),
            count(
                "turns",
                "number of turns; a turn is a series of acts, replies, texts and votes of one seat that no other seat "
                "interrupts",
                lambda row: in_game(row, row.group.acts.turns),
            ),
            text(
                "bag",
                "recording of the game, relative to the study's folder; empty if there is none",
                lambda row: None if row.group.trial is None else row.group.trial.bag,
            ),
            text("sha256", "SHA-256 of the recording, from the log", lambda row: row.group.logged("sha256")),
            text(
                "recording",
                "state of the recording at this export, as in the table trials",
                lambda row: str(row.group.state),
            ),
        ),
    )
    return table.of([GroupedRow(game)])


_PERSON, _PROGRAM, _EMPTY = SeatHolder.PERSON, SeatHolder.PROGRAM, SeatHolder.EMPTY


def seats(design: ExperimentDesign, game: RecordedGroup) -> ExperimentTable:
    """Return the rows of the seats of a game: who had which seat, and what each seat said and did."""

    def first_change(row: _Seat, kind: EventKind) -> float | None:
        changes = row.group.changes.get(row.seat, ())
        return next((change.time for change in changes if change.kind == kind), None)

    def of_recording(row: _Seat, value: int) -> int | None:
        return None if row.group.recording is None else value

    def counted(name: str, meaning: str, of: str = "") -> ValuedColumn[_Seat]:
        return count(name, meaning, lambda row: of_recording(row, getattr(row.acts, of or name)))

    def turn_share(row: _Seat) -> float | None:
        turns = row.group.acts.turns
        return row.acts.turns / turns if turns else None

    table: TableOf[_Seat] = TableOf(
        "seats",
        "a seat in a game of a group",
        (
            *game_columns(design),
            text("seat", "name of the seat", lambda row: row.seat),
            text(
                "participant",
                "id of the person who took the seat at the start; empty for programs, empty seats, and people who "
                "withdrew",
                lambda row: row.group.participant(row.seat),
            ),
            text(
                "holder",
                "holder of the seat at the start: person, program (a simulated participant) or empty",
                lambda row: str(row.group.game.began[row.seat]),
            ),
            text(
                "holder_at_end",
                "holder of the seat at the end of the game",
                lambda row: str(row.group.game.seats[row.seat]),
            ),
            seconds(
                "left_s",
                "simulated time since the first tick at which the person first left the seat; empty if they did not",
                lambda row: first_change(row, EventKind.SEAT_LEFT),
            ),
            seconds(
                "filled_s",
                "simulated time since the first tick at which a program first took the seat; empty if none did",
                lambda row: first_change(row, EventKind.SEAT_FILLED),
            ),
            seconds(
                "resumed_s",
                "simulated time since the first tick at which the person first came back; empty if they did not",
                lambda row: first_change(row, EventKind.SEAT_RESUMED),
            ),
            seconds(
                "waited_s",
                "time for which the person waited in the lobby",
                lambda row: row.group.waited.get(row.seat),
            ),
            counted("moves", "number of moves of robots to rooms that the seat decided"),
            counted("pictures", "number of pictures that the seat took and that cost energy"),
            counted("identified", "number of treasures that the seat named, rightly or wrongly", "named"),
            whole("points", "points for these names", lambda row: of_recording(row, row.acts.points)),
            counted("replies", "number of sentences of the seat in dialogues with robots"),
            counted("texts", "number of texts of the seat to other seats"),
            counted("characters", "total length of these texts, in characters"),
            counted("proposed", "number of decisions that the seat proposed for a vote"),
            counted("votes", "number of votes of the seat on decisions that others proposed"),
            counted("votes_for", "number of these votes that agree", "agreed"),
            counted("objections", "number of objections of the seat in dialogues of other seats"),
            counted(
                "objections_followed",
                "number of these objections that were followed, as in the table objections",
                "followed",
            ),
            counted("turns", "number of turns of the seat, as in the table groups"),
            share("turn_share", "share of the seat in all turns of the game", turn_share),
        ),
    )
    return table.of(_Seat(game, seat, game.acts.of(seat)) for seat in game.game.began)


def texts(design: ExperimentDesign, game: RecordedGroup) -> ExperimentTable:
    """Return the rows of the texts between the people of a game, one for each person who could read a text."""
    table: TableOf[_Text] = TableOf(
        "texts",
        "a text of a person, for one addressee",
        (
            *game_columns(design),
            whole("line", "number of the text in the game, from 1", lambda row: row.said.line, least=1),
            *_who("author", "author of the text", _Text.author_seat, _Text.sent),
            *_who("reader", "addressee", _Text.reader_seat, _Text.sent),
            flag("to_all", "true if the text was for all seats", lambda row: not row.said.to),
            seconds("time_s", "simulated time since the start of the game at which it was sent", lambda row: row.time),
            seconds("typing_s", "time from the first key to sending", lambda row: row.said.typing),
            seconds(
                "read_s",
                "simulated time since the start of the game at which the addressee's program showed it; empty if it "
                "did not",
                lambda row: row.read,
            ),
            seconds(
                "read_after_s",
                "read_s minus time_s",
                lambda row: None if row.read is None else max(0.0, row.read - row.time),
            ),
            text("text", "the text", lambda row: row.said.text),
        ),
    )
    return table.of(texts_in(game))


def joint_decisions(design: ExperimentDesign, game: RecordedGroup) -> ExperimentTable:
    """Return the rows of the decisions on which the people of a game voted."""

    def seats_that(row: _DecisionRow, *, agree: bool) -> str | None:
        return "; ".join(vote.seat for vote in row.made.votes if vote.agrees is agree) or None

    table: TableOf[_DecisionRow] = TableOf(
        "joint_decisions",
        "a decision on which people voted",
        (
            *game_columns(design),
            *_decision_columns(),
            text(
                "outcome",
                f"{', '.join(DecisionOutcome)}; void: the decision became impossible; empty if the game ended before",
                lambda row: row.made.outcome,
            ),
            whole("needs", "number of people who had to agree", lambda row: row.made.proposed.needs, least=1),
            text(
                "agreed_by", "seats that agreed, with the one that proposed it", lambda row: seats_that(row, agree=True)
            ),
            text("rejected_by", "seats that did not agree", lambda row: seats_that(row, agree=False)),
            seconds(
                "decision_s",
                "simulated time from the proposal to the end of the vote",
                lambda row: None if row.made.settled is None else row.made.settled - row.made.time,
            ),
        ),
    )
    return table.of(_DecisionRow(game, made) for made in joint_decisions_in(game))


def votes(design: ExperimentDesign, game: RecordedGroup) -> ExperimentTable:
    """Return the rows of the votes in a game. The proposal of a decision is the first vote for it."""
    table: TableOf[_VoteRow] = TableOf(
        "votes",
        "a vote of a person on a decision",
        (
            *game_columns(design),
            *_decision_columns(),
            *_who("voter", "voter", _VoteRow.voter, _VoteRow.voted),
            flag("agrees", "true if the voter agrees", lambda row: row.vote.agrees),
            text("reason", "reason that the voter gave", lambda row: row.vote.reason or None),
            seconds("time_s", "simulated time of the vote since the start of the game", lambda row: row.vote.time),
            seconds(
                "after_proposal_s",
                "simulated time from the proposal to the vote",
                lambda row: row.vote.time - row.made.time,
            ),
        ),
    )
    return table.of(_VoteRow(game, made, vote) for made in joint_decisions_in(game) for vote in made.votes)


def objections(design: ExperimentDesign, game: RecordedGroup) -> ExperimentTable:
    """Return the rows of the objections in a game."""
    table: TableOf[_Objection] = TableOf(
        "objections",
        "an objection of a person in a dialogue of another seat with a robot",
        (
            *game_columns(design),
            whole(
                "talk",
                "number of the dialogue, as in the tables moves and dialogue_games",
                lambda row: row.answered.raised.dialogue,
            ),
            whole(
                "robot",
                "number of the robot in the dialogue, from 1",
                lambda row: number_of(row.answered.raised.robot),
                least=1,
            ),
            whole("room", "number of the room in the dialogue", lambda row: row.answered.raised.room.people),
            text(
                "matter",
                "subject of the dialogue: select-room, take-picture or take-treasure",
                lambda row: row.answered.matter or None,
            ),
            *_who("objector", "person who objects", _Objection.objector, _Objection.raised),
            text(
                "decided_by",
                "seat that talked with the robot; empty if it said nothing",
                lambda row: row.answered.decider or None,
            ),
            text("reason", f"{', '.join(ObjectionReason)}", lambda row: str(row.answered.raised.reason)),
            text("text", "own words of the person who objects", lambda row: row.answered.raised.text or None),
            seconds(
                "time_s", "simulated time of the objection since the start of the game", lambda row: row.answered.time
            ),
            flag(
                "followed",
                "true if what the dialogue proposed was not done before the next dialogue with this robot",
                lambda row: row.answered.followed,
            ),
        ),
    )
    found = [] if game.recording is None else objections_in(game.recording)
    return table.of(_Objection(game, answered) for answered in found)


def game_columns(design: ExperimentDesign) -> tuple[ValuedColumn[GroupedRow], ...]:
    """Return the first columns of each row that belongs to a game of a group."""

    def of_game(column: ValuedColumn[OfAttempt]) -> ValuedColumn[GroupedRow]:
        return ValuedColumn(column.described, lambda row: column.value(subject_of(row.group)))

    shared = [
        of_game(column)
        for column in attempt_columns(design)
        if column.described.name not in {*_OF_A_PERSON, design.pairing_factor}
    ]
    return (
        text("group", "id of the group", lambda row: row.group.game.group),
        flag(
            "counts",
            "true for valid data: the runs of all people of the group are complete and not excluded, and the step is "
            "not practice",
            lambda row: row.group.all_count and row.group.attempt.step.trial is not None,
        ),
        *shared,
    )


def _decision_columns() -> tuple[ValuedColumn[_DecisionRow], ...]:
    return (
        whole(
            "decision", "number of the decision in the game, from 1", lambda row: row.made.proposed.decision, least=1
        ),
        text(
            "decided",
            "kind of the decision: send (a robot to a room), name (a treasure) or end (the game)",
            lambda row: str(row.made.proposed.kind),
        ),
        whole(
            "robot",
            "number of the robot, from 1; only for send",
            lambda row: None if row.made.proposed.robot is None else number_of(row.made.proposed.robot),
            least=1,
        ),
        whole(
            "room",
            "number of the destination, or of the treasure's room",
            lambda row: None if row.made.proposed.room is None else row.made.proposed.room.people,
        ),
        text("treasure", "proposed name of the treasure", lambda row: row.made.proposed.name or None),
        *_who("proposed_by", "proposer", _DecisionRow.proposer, _DecisionRow.began),
        seconds("proposed_s", "simulated time of the proposal since the start of the game", lambda row: row.made.time),
    )


def _who(name: str, role: str, seat: Callable[[G], str], time: Callable[[G], float]) -> tuple[ValuedColumn[G], ...]:
    """Return the columns about a person: seat, participant, and holder of the seat at that time."""
    return (
        text(name, f"seat of the {role}", seat),
        text(
            f"{name}_participant",
            f"id of the person whose seat it is; see {name}_holder",
            lambda row: row.group.participant(seat(row)),
        ),
        text(
            f"{name}_holder",
            "holder of this seat at that time: person, program (a simulated participant), researcher or empty",
            lambda row: str(row.group.holder(seat(row), time(row))),
        ),
    )


def texts_in(game: RecordedGroup) -> Iterator[_Text]:
    """Yield the texts of a game, once for each seat that could read them."""
    entries = [] if game.recording is None else game.recording.team
    for each in entries:
        if not isinstance(said := each.entry, PersonSaid):
            continue
        for reader in [said.to] if said.to else [seat for seat in game.game.began if seat != said.seat]:
            reads = (
                other.time
                for other in entries
                if isinstance(read := other.entry, PersonRead) and read.seat == reader and read.line >= said.line
            )
            yield _Text(game, each.time, said, reader, next(reads, None))


def joint_decisions_in(game: RecordedGroup) -> Iterator[_Decision]:
    """Yield the decisions on which people voted, with their votes."""
    found: dict[int, _Decision] = {}
    for each in [] if game.recording is None else game.recording.team:
        match each.entry:
            case DecisionProposed() as proposed:
                own = _Vote(proposed.seat, True, "", each.time)
                found[proposed.decision] = _Decision(each.time, proposed, [own])
            case VoteCast() as vote if vote.decision in found:
                found[vote.decision].votes.append(_Vote(vote.seat, vote.agrees, vote.reason, each.time))
            case DecisionSettled() as settled if settled.decision in found:
                made = found[settled.decision]
                made.settled, made.outcome = each.time, str(settled.outcome)
    yield from found.values()
