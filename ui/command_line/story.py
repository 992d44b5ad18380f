"""Sentences about the events of a hunt, for the terminal."""

from collections.abc import Iterator, Sequence

from sim.common.observations import TICK
from sim.common.robot_numbers import robot_name
from thbridge.app.session.session import TickRecord
from thbridge.dialogue.moves import Author, DialogueUtterance, Speaker
from thbridge.hunt.costs import energy_text
from thbridge.hunt.event_words import ENDS
from thbridge.hunt.events import (
    Commander,
    CommanderChanged,
    Condition,
    ConditionChanged,
    ConsentGiven,
    CostsEstimated,
    Event,
    GameEnded,
    GameStarted,
    HandbackRequested,
    MoveFailed,
    PropertyMeasured,
    PropertyTold,
    RobotArrived,
    RobotDeparted,
    RoomAdvised,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
    TreasureSensed,
    TreasuresHidden,
    TreasureTakenUp,
)
from thbridge.hunt.properties import value_in_words
from thbridge.hunt.rooms import Room, RoomNames
from thbridge.hunt.rules import commander_name
from thbridge.hunt.seats import Seat, capitalized, label_of
from thbridge.hunt.team_words import entry_in_words, seat_of_entry
from thbridge.hunt.treasures import name_in_words
from ui.command_line.terminal import show


def print_story(tick: TickRecord, rooms: RoomNames) -> None:
    """Print what happened in a tick; `rooms` are the names of the map's rooms."""
    for sentence in tell(tick, rooms):
        show(sentence)


def tell(tick: TickRecord, rooms: RoomNames) -> Iterator[str]:
    """Yield the sentences about one tick. Each begins with its simulated time."""
    seats = () if tick.game is None else tick.game.started.seats
    for utterance in tick.utterances:
        yield _timed(tick, _sentence(utterance, seats))
    for event in tick.events:
        seat: str = getattr(event, "seat", "")
        who = capitalized(label_of(seats, seat))
        sentence = _happened(event, rooms, seats, who)
        if sentence:
            yield _timed(tick, f"{who}: {sentence}" if seat and not sentence.startswith(who) else sentence)
    for entry in tick.team:
        seat = seat_of_entry(entry)
        words = f"{label_of(seats, seat) if seat else ''} {entry_in_words(entry, rooms)}".strip()
        yield _timed(tick, capitalized(words))


CONDITIONS = {
    Condition.WELL: "responds again and knows where it is.",
    Condition.LOST: "does not know where it is.",
    Condition.SILENT: "no longer responds.",
}
"""Sentences about a robot's new condition."""


def _timed(tick: TickRecord, sentence: str) -> str:
    return f"{tick.tick * TICK:7.1f} s  {sentence}"


def _sentence(utterance: DialogueUtterance, seats: Sequence[Seat]) -> str:
    robot = utterance.topic.robot
    person = capitalized(label_of(seats, utterance.seat)) if seats else "You"
    robot_text = robot_name(robot)
    speaker = robot_text.capitalize() if utterance.speaker is Speaker.ROBOT else f"{person} to {robot_text}"
    wizard = " (said by the researcher)" if utterance.author is Author.WIZARD else ""
    return f"{speaker}{wizard}: {utterance.text}"


def _happened(event: Event, rooms: RoomNames, seats: Sequence[Seat], who: str) -> str:
    """Return a sentence about an event. For advice it is empty, because the robot itself says the advice.

    Args:
        event: the event.
        rooms: names of the map's rooms.
        seats: seats of the game.
        who: words for the participant who caused the event, for the beginning of the sentence.
    """

    def titled(room: Room) -> str:
        return rooms.titled(room.people)

    match event:
        case GameStarted(game=game, robots=robots):
            return f"Game {game} begins with {robots} robot{'s' if robots > 1 else ''}."
        case TreasuresHidden(treasures):
            return f"{len(treasures)} treasures are hidden."
        case ConsentGiven():
            return f"{who} has agreed to take part."
        case RoomAdvised():
            return ""
        case RobotDeparted(robot, room, cost):
            return f"{robot_name(robot).capitalize()} leaves for {titled(room)}; this costs {energy_text(cost)} energy."
        case RobotArrived(robot, room):
            return f"{robot_name(robot).capitalize()} has reached {titled(room)}."
        case MoveFailed(robot, room, reason, refund):
            back = f" It gets {energy_text(refund)} energy back." if refund > 0.0 else ""
            return f"{robot_name(robot).capitalize()} does not reach {titled(room)}: {reason}{back}"
        case ConditionChanged(robot, condition):
            return f"{robot_name(robot).capitalize()} {CONDITIONS[condition]}"
        case CostsEstimated(robot):
            return f"{robot_name(robot).capitalize()} has estimated the costs of its moves from its position."
        case CommanderChanged(robot, by, name):
            commander = name if by is Commander.RESEARCHER and name else commander_name(by, name)
            commander = label_of(seats, name) if by is Commander.PARTICIPANT else commander
            return f"{robot_name(robot).capitalize()} is now commanded by {commander}."
        case HandbackRequested(robot):
            return f"{who} asks to command {robot_name(robot)}{'' if seats else ' again'}."
        case TreasureSensed(room, properties):
            what = f"Something {', '.join(map(value_in_words, properties.values()))}".strip()
            return f"{what} is in {titled(room)}."
        case PropertyMeasured(room, robot, name, value):
            return f"{robot_name(robot).capitalize()} senses in {titled(room)}: {_property_in_words(name, value)}."
        case PropertyTold(room, name, value):
            return f"{who} reports from {titled(room)}: {_property_in_words(name, value)}."
        case TreasurePictured(room, robot):
            return f"{robot_name(robot).capitalize()} takes a picture in {titled(room)}."
        case TreasureIdentified(room, _, name, points):
            place = "" if room is None else f" in {titled(room)}"
            named = "named" if name is None else f"named {name_in_words(name)}"
            return f"The treasure{place} is {named}: {points:+d} points."
        case TreasureLeft(room):
            return f"The treasure in {titled(room)} is left undecided."
        case TreasureTakenUp(room):
            return f"{who} considers the treasure in {titled(room)} again."
        case GameEnded(reason, score):
            return f"The game is over: {ENDS[reason]}. Score {score}."


def _property_in_words(name: str, value: str) -> str:
    return f"{name_in_words(name)} {value_in_words(value)}"
