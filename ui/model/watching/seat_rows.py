"""Seats of a game in words, for the researcher's window: presence, robots, dialogues, texts and votes."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from sim.common.robot_numbers import number_of
from thbridge.hunt.events import DecisionOutcome, PersonSaid
from thbridge.hunt.rooms import RoomNames
from thbridge.hunt.seats import DialogueSight, PlayedBy, Seat, StopRight, capitalized, label_of
from thbridge.hunt.team_words import proposal_in_words
from ui.model.watching.bookmarks import clock
from ui.model.watching.seat_log import SeatsState, SeatVote

Presence = Literal["person", "program", "researcher", "away", "not taken"]

_PRESENCE: dict[PlayedBy, Presence] = {
    PlayedBy.PERSON: "person",
    PlayedBy.PROGRAM: "program",
    PlayedBy.RESEARCHER: "researcher",
}
PRESENCE_WORDS: dict[Presence, str] = {
    "person": "here",
    "program": "program",
    "researcher": "researcher",
    "away": "away",
    "not taken": "not taken",
}
"""Words for the presence at a seat."""
_OUTCOMES = {
    DecisionOutcome.CARRIED: "agreed",
    DecisionOutcome.REJECTED: "rejected",
    DecisionOutcome.EXPIRED: "ended without a decision",
    DecisionOutcome.VOID: "void, because it became impossible",
}


@dataclass(frozen=True, slots=True)
class SeatRow:
    """Seat in words.

    Attributes:
        name: name of the seat.
        label: words for the seat.
        presence: who is at the seat.
        robots: the robots that the seat commands now.
        talks: the robots that have an open dialogue with the seat; empty if there is none.
        rights: rights of the seat.
    """

    name: str
    label: str
    presence: Presence
    robots: str
    talks: str
    rights: str

    @property
    def why_not_played(self) -> str:
        """Reason why a researcher cannot take the seat now; empty if they can."""
        match self.presence:
            case "person":
                return (
                    f"A person plays the seat {self.name}. You can take a seat that is empty, or whose person is away."
                )
            case "program":
                return f"A program plays the seat {self.name}. You can take a seat that is empty."
            case "researcher":
                return f"A researcher already plays the seat {self.name}."
            case _:
                return ""


@dataclass(frozen=True, slots=True)
class TeamLine:
    """Text or vote of the people.

    Attributes:
        time: time of its beginning, in words.
        title: author and addressee of a text, or proposer and subject of a vote.
        body: the text; for a vote, the votes with their reasons.
        state: who has read the text, or the result of the vote.
        is_open: True for a text that was not read by all, and for an open vote.
    """

    time: str
    title: str
    body: str
    state: str
    is_open: bool


def seat_rows(state: SeatsState) -> tuple[SeatRow, ...]:
    """Return the rows of all seats, in the order of the study."""
    return tuple(
        SeatRow(
            name=seat.name,
            label=capitalized(seat.label),
            presence=_presence(state, seat.name),
            robots=_robots(robot for robot, commander in state.commands.items() if commander == seat.name)
            or "no robot",
            talks=_robots(each.robot for each in state.dialogues if each.seat == seat.name),
            rights=rights_in_words(seat),
        )
        for seat in state.seats
    )


def rights_in_words(seat: Seat) -> str:
    """Return what a seat may do and see, as far as it differs between seats, in a few words."""
    stops = {StopRight.NONE: "stops no robot", StopRight.ALL: "stops all robots", StopRight.OWN: ""}
    parts = [
        "names treasures" if seat.names_treasures else "",
        stops[seat.stops],
        "" if seat.talks else "does not talk with robots",
        "sees only its own dialogues" if seat.sees_dialogues is DialogueSight.OWN else "",
        "" if seat.ends_game else "cannot end the game",
        *(
            f"no {what}"
            for what, sees in (("map", seat.sees_map), ("energy", seat.sees_energy), ("score", seat.sees_score))
            if not sees
        ),
    ]
    return ", ".join(part for part in parts if part)


def team_lines(state: SeatsState, rooms: RoomNames, start_ns: int) -> tuple[TeamLine, ...]:
    """Return the texts and votes of the people, oldest first.

    Args:
        state: the seats.
        rooms: names of the rooms.
        start_ns: ROS time at which the displayed times are zero.
    """
    start = (state.zero_ns - start_ns) / 1e9
    texts = ((text.at, _text(state, text, start)) for text in state.texts)
    votes = ((vote.proposed.at, _vote(state, vote, rooms, start)) for vote in state.votes.values())
    return tuple(line for _, line in sorted((*texts, *votes), key=lambda timed: timed[0]))


def _presence(state: SeatsState, seat: str) -> Presence:
    by = state.played.get(seat)
    if by is not None:
        return _PRESENCE[by]
    return "away" if seat in state.left else "not taken"


def _robots(robots: Iterator[int]) -> str:
    numbers = [str(number_of(robot)) for robot in sorted({*robots})]
    return f"robot{'s' if len(numbers) > 1 else ''} {', '.join(numbers)}" if numbers else ""


def _text(state: SeatsState, text: PersonSaid, start: float) -> TeamLine:
    readers = [text.to] if text.to else [seat.name for seat in state.seats if seat.name != text.seat]
    read = [(label_of(state.seats, seat), state.read_at(text, seat)) for seat in readers]
    missing = [label for label, at in read if at is None]
    done = [f"{label} {clock(start + at)}" for label, at in read if at is not None]
    parts = [f"read by {', '.join(done)}" if done else "", f"not read by {', '.join(missing)}" if missing else ""]
    to = label_of(state.seats, text.to) if text.to else "all"
    title = f"{capitalized(label_of(state.seats, text.seat))} to {to}"
    return TeamLine(clock(start + text.at), title, text.text, "; ".join(part for part in parts if part), bool(missing))


def _vote(state: SeatsState, vote: SeatVote, rooms: RoomNames, start: float) -> TeamLine:
    proposed, latest = vote.proposed, {each.seat: each for each in vote.cast}
    cast = [f"✓ {label_of(state.seats, proposed.seat)} (proposed it)"]
    for each in latest.values():
        because = f": {each.reason}" if each.reason else ""
        cast.append(f"{'✓' if each.agrees else '✗'} {label_of(state.seats, each.seat)}{because}")
    agree = 1 + sum(each.agrees for each in latest.values())  # of integers
    if vote.settled is None:
        waits = [label_of(state.seats, seat) for seat in state.played if seat not in {*latest, proposed.seat}]
        awaited = f"; waits for {', '.join(waits)}" if waits else ""
        result = f"open: {agree} of {proposed.needs} agree{awaited}"
    else:
        seconds = vote.settled.at - proposed.at
        result = f"{_OUTCOMES[vote.settled.outcome]} after {seconds:.0f} s; {agree} of {proposed.needs} agreed"
    title = f"{capitalized(label_of(state.seats, proposed.seat))} proposes: {proposal_in_words(proposed, rooms)}"
    return TeamLine(clock(start + proposed.at), title, "\n".join(cast), result, vote.settled is None)
