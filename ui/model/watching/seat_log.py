"""Log of the seats of a game: who plays them, their texts and votes, and their dialogues with robots, at any time."""

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import msgspec

from thbridge.hunt.events import (
    Commander,
    DecisionProposed,
    DecisionSettled,
    PersonRead,
    PersonSaid,
    SeatLeft,
    SeatTaken,
    TeamEntry,
    VoteCast,
)
from thbridge.hunt.seats import PlayedBy, Seat, commanding_seat
from thbridge.ros.messages.session_records import SeatNotice

MAX_STATES = 50_000
"""Maximum number of states that are kept; when there are more, the oldest are dropped."""


@dataclass(frozen=True, slots=True)
class SeatVote:
    """Vote on a decision, with the votes so far and the end of the vote; None while it is open."""

    proposed: DecisionProposed
    cast: tuple[VoteCast, ...] = ()
    settled: DecisionSettled | None = None


@dataclass(frozen=True, slots=True)
class SeatDialogue:
    """Open dialogue of a robot: its matter, and the seat that answers the robot."""

    robot: int
    matter: str
    seat: str


@dataclass(frozen=True, slots=True)
class SeatsState:
    """Seats of a game at a certain time.

    Attributes:
        seats: the seats; empty in a game with one participant.
        played: who plays each seat; seats without a player are missing.
        left: seats that were played before, and have no player now.
        commands: seat that commands each robot, by index; robots of other commanders are missing.
        shown: dialogues that each seat sees.
        texts: texts between people, oldest first.
        reads: reports that texts were read, oldest first.
        votes: votes by number of the decision, oldest first.
        zero_ns: ROS time at the simulated time 0, nanoseconds.
    """

    seats: tuple[Seat, ...] = ()
    played: Mapping[str, PlayedBy] = field(default_factory=dict)
    left: frozenset[str] = frozenset()
    commands: Mapping[int, str] = field(default_factory=dict)
    shown: Mapping[str, tuple[SeatDialogue, ...]] = field(default_factory=dict)
    texts: tuple[PersonSaid, ...] = ()
    reads: tuple[PersonRead, ...] = ()
    votes: Mapping[int, SeatVote] = field(default_factory=dict)
    zero_ns: int = 0

    @property
    def dialogues(self) -> tuple[SeatDialogue, ...]:
        """Open dialogues of all robots, by what all seats see."""
        found = {each for dialogues in self.shown.values() for each in dialogues}
        return tuple(sorted(found, key=lambda each: (each.robot, each.matter, each.seat)))

    def read_at(self, text: PersonSaid, seat: str) -> float | None:
        """Return the simulated time at which a seat had read a text; None if it has not read the text."""
        return next((read.at for read in self.reads if read.seat == seat and read.line >= text.line), None)


class _ShownDialogue(msgspec.Struct):
    dialogue: int
    robot: int
    matter: str = ""


class _ShownTeam(msgspec.Struct):
    partners: tuple[tuple[int, str], ...] = ()


class _ShownGame(msgspec.Struct):
    """The parts of a participant's view about the partners of robots' dialogues."""

    dialogues: tuple[_ShownDialogue, ...] = ()
    team: _ShownTeam | None = None


class SeatLog:
    """Log of the seats; entries must be added in order of time."""

    def __init__(self) -> None:
        self._stamps: list[int] = []
        self._states = [SeatsState()]

    def at(self, until_ns: int) -> SeatsState:
        """Return the seats at a time."""
        return self._states[bisect_right(self._stamps, until_ns)]

    def begin(self, stamp: int, fields: Mapping[str, object]) -> None:
        """Begin a game, with the fields of its first event."""
        robots = fields.get("robots")
        try:
            seats = msgspec.convert(fields.get("seats", ()), tuple[Seat, ...])
        except msgspec.ValidationError:
            seats = ()
        if seats or self._states[-1].seats:
            numbers = range(robots if seats and isinstance(robots, int) else 0)
            self._add(stamp, SeatsState(seats, commands={robot: commanding_seat(seats, robot) for robot in numbers}))

    def command(self, stamp: int, robot: int, fields: Mapping[str, object]) -> None:
        """Record the new commander of a robot."""
        now = self._states[-1]
        if not now.seats:
            return
        commands = {other: seat for other, seat in now.commands.items() if other != robot}
        if fields.get("by") == Commander.PARTICIPANT:
            commands[robot] = str(fields.get("name", ""))
        self._add(stamp, replace(now, commands=commands))

    def take(self, stamp: int, entry: TeamEntry) -> None:
        """Add an entry about the participants."""
        now = replace(self._states[-1], zero_ns=stamp - round(entry.at * 1e9))
        match entry:
            case SeatTaken(seat=seat, by=by):
                now = replace(now, played={**now.played, seat: by}, left=now.left - {seat})
            case SeatLeft(seat=seat):
                played = {other: by for other, by in now.played.items() if other != seat}
                shown = {other: dialogues for other, dialogues in now.shown.items() if other != seat}
                now = replace(now, played=played, left=now.left | {seat}, shown=shown)
            case PersonSaid():
                now = replace(now, texts=(*now.texts, entry))
            case PersonRead():
                now = replace(now, reads=(*now.reads, entry))
            case DecisionProposed():
                now = replace(now, votes={**now.votes, entry.decision: SeatVote(entry)})
            case VoteCast(decision=number) if number in now.votes:
                vote = now.votes[number]
                now = replace(now, votes={**now.votes, number: replace(vote, cast=(*vote.cast, entry))})
            case DecisionSettled(decision=number) if number in now.votes:
                now = replace(now, votes={**now.votes, number: replace(now.votes[number], settled=entry)})
            case _:
                return
        self._add(stamp, now)

    def show(self, stamp: int, notice: SeatNotice) -> None:
        """Record the dialogues that a participant sees."""
        now = self._states[-1]
        if notice.kind != "View" or not now.seats:
            return
        try:
            view = msgspec.json.decode(notice.json, type=_ShownGame)
        except msgspec.DecodeError:
            return
        partners = dict(() if view.team is None else view.team.partners)
        dialogues = tuple(
            SeatDialogue(each.robot, each.matter, partners.get(each.dialogue, notice.seat)) for each in view.dialogues
        )
        if now.shown.get(notice.seat, ()) != dialogues:
            self._add(stamp, replace(now, shown={**now.shown, notice.seat: dialogues}))

    def _add(self, stamp: int, state: SeatsState) -> None:
        if self._stamps and stamp < self._stamps[-1]:
            return
        self._stamps.append(stamp)
        self._states.append(state)
        if len(self._stamps) > MAX_STATES:
            del self._stamps[: MAX_STATES // 10], self._states[: MAX_STATES // 10]
