"""Seats of a game: the places of people or programs that play together, with what each may do and see.

A game without seats has one participant, who may do and see everything. In recordings and requests, the name of this
participant's seat is empty.
"""

import re
from collections.abc import Sequence
from enum import StrEnum
from typing import Final

import msgspec
from msgspec import UNSET, UnsetType

MOST_SEATS = 8
"""Greatest number of seats in a game."""

SEAT_NAME: Final = re.compile(r"[a-z][a-z0-9-]{0,19}")
"""Form of the names of seats. A name is a part of names in the text protocol and of ROS topics."""


class StopRight(StrEnum):
    """Robots that a seat may stop."""

    NONE = "none"
    OWN = "own"
    ALL = "all"


class DialogueSight(StrEnum):
    """Dialogues that a seat sees: only its own, or those of all seats."""

    OWN = "own"
    ALL = "all"


class PlayedBy(StrEnum):
    """Player of a seat: a person, a program (such as a simulated participant), or a researcher in their place."""

    PERSON = "person"
    PROGRAM = "program"
    RESEARCHER = "researcher"


class Seat(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One seat of a game.

    Attributes:
        name: name of the seat; see `SEAT_NAME`.
        label: words for the seat in sentences, such as "the driver".
        robots: indices of the robots that the seat commands at the start.
        takes_over: True if it may take over robots that other seats hand over; see `can_take_over`.
        names_treasures: True if it may name treasures, leave them, and report their visible properties.
        stops: robots that it may stop.
        talks: True if it may have dialogues with robots.
        ends_game: True if it may end the game early.
        sees_dialogues: dialogues that it sees.
        sees_energy: True if it sees the robots' energy and the costs of moves.
        sees_map: True if it sees the map and the robots' positions on it.
        sees_score: True if it sees the score and the points of treasures.
        objects: True if it may object in the dialogues of other seats; see `may_object`. Otherwise unset, so that
            recordings of games without this right do not contain it.
    """

    name: str
    label: str
    robots: tuple[int, ...] = ()
    takes_over: bool = True
    names_treasures: bool = True
    stops: StopRight = StopRight.OWN
    talks: bool = True
    ends_game: bool = True
    sees_dialogues: DialogueSight = DialogueSight.ALL
    sees_energy: bool = True
    sees_map: bool = True
    sees_score: bool = True
    objects: bool | UnsetType = UNSET

    @property
    def can_take_over(self) -> bool:
        """True if it may take over robots. A robot drives only after a dialogue, so the seat must be able to talk."""
        return self.takes_over and self.talks

    @property
    def may_object(self) -> bool:
        """True if it may object in dialogues of other seats. It must see these dialogues."""
        return self.objects is True and self.sees_dialogues is DialogueSight.ALL


ONE_SEAT = Seat("", "the participant", stops=StopRight.ALL)
"""Seat of the participant in a game without seats."""


def seat_named(seats: Sequence[Seat], name: str) -> Seat | None:
    """Return the seat with this name, or None. A game without seats has one seat, whose name is empty."""
    if not seats:
        return ONE_SEAT if not name else None
    return next((seat for seat in seats if seat.name == name), None)


def commanding_seat(seats: Sequence[Seat], robot: int) -> str:
    """Return the name of the seat that commands a robot at the start; empty in a game without seats.

    A robot that no seat lists is commanded by the first seat that may command robots.
    """
    listed = (seat.name for seat in seats if robot in seat.robots)
    others = (seat.name for seat in seats if seat.robots)
    return next(listed, next(others, seats[0].name if seats else ""))


def label_of(seats: Sequence[Seat], name: str) -> str:
    """Return the words for the participant of a seat in a sentence; see `seat_named`."""
    seat = seat_named(seats, name)
    return "a participant" if seat is None else seat.label


def capitalized(label: str) -> str:
    """Return a label for the beginning of a sentence."""
    return label[:1].upper() + label[1:]


def labels_of(seats: Sequence[Seat]) -> str:
    """Return the labels of seats for a sentence, such as "the driver or the namer"; "a researcher" for no seats."""
    *others, last = [seat.label for seat in seats] or ["a researcher"]
    return f"{', '.join(others)} or {last}" if others else last
