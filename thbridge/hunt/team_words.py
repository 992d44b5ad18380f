"""Words for people for the presence, texts and votes of participants, in games with several seats."""

from sim.common.robot_numbers import robot_name
from thbridge.hunt.events import (
    DecisionKind,
    DecisionProposed,
    DecisionSettled,
    ObjectionRaised,
    PersonRead,
    PersonSaid,
    SeatLeft,
    SeatTaken,
    TeamEntry,
    VoteCast,
)
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.hunt.seats import PlayedBy
from thbridge.hunt.treasures import name_in_words


def seat_of_entry(entry: TeamEntry) -> str:
    """Return the seat of the participant; empty for the end of a vote."""
    return "" if isinstance(entry, DecisionSettled) else entry.seat


def entry_in_words(entry: TeamEntry, rooms: RoomNames) -> str:
    """Return an entry as a part of a sentence, without the participant's seat.

    Args:
        entry: the entry.
        rooms: names of the map's rooms.
    """
    match entry:
        case SeatTaken(by=PlayedBy.PERSON):
            return "joins"
        case SeatTaken(by=by):
            return f"is played by a {by}"
        case SeatLeft():
            return "is disconnected"
        case PersonSaid(line=line, to=to, text=text):
            return f"message {line} to {to or 'all'}: {text}"
        case PersonRead(line):
            return f"has read the messages up to {line}"
        case DecisionProposed(decision=number, needs=needs):
            return f"proposes decision {number}: {proposal_in_words(entry, rooms)}; {needs} must agree"
        case VoteCast(decision=number, agrees=agrees, reason=reason):
            because = f": {reason}" if reason else ""
            return f"{'agrees' if agrees else 'does not agree'} to decision {number}{because}"
        case DecisionSettled(number, outcome):
            return f"vote on decision {number}: {outcome}"
        case ObjectionRaised(dialogue=number, robot=robot, room=room, reason=reason, text=text):
            about = f"with {robot_name(robot)} about {rooms.titled(room.people)}"
            because = f": {text}" if text else ""
            return f"objects in dialogue {number} {about}: {reason.replace('-', ' ')}{because}"


def proposal_in_words(entry: DecisionProposed, rooms: RoomNames) -> str:
    """Return what a participant proposes, as a clause."""
    room = rooms.titled((entry.room or Room(0)).people)
    match entry.kind:
        case DecisionKind.SEND:
            return f"{robot_name(entry.robot or 0)} drives to {room}"
        case DecisionKind.NAME:
            return f"the treasure in {room} is {name_in_words(entry.name)}"
        case DecisionKind.END:
            return "the game ends"
