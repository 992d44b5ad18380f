"""Sentences about the events of a hunt, for the terminal."""

from collections.abc import Iterator

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
from thbridge.hunt.team_words import entry_in_words, seat_of_entry
from thbridge.hunt.treasures import name_in_words
from ui.command_line.terminal import show


def print_story(tick: TickRecord, rooms: RoomNames) -> None:
    """Print what happened in a tick; `rooms` are the names of the map's rooms."""
    for sentence in tell(tick, rooms):
        show(sentence)


def tell(tick: TickRecord, rooms: RoomNames) -> Iterator[str]:
    """Yield the sentences about one tick. Each begins with its simulated time."""
    for utterance in tick.utterances:
        yield _timed(tick, _sentence(utterance))
    for event in tick.events:
        sentence = _happened(event, rooms)
        if sentence:
            seat = getattr(event, "seat", "")
            yield _timed(tick, f"{sentence} ({seat})" if seat else sentence)
    for entry in tick.team:
        words = f"{seat_of_entry(entry)} {entry_in_words(entry, rooms)}".strip()
        yield _timed(tick, f"{words[0].upper()}{words[1:]}")


CONDITIONS = {
    Condition.WELL: "responds again and knows where it is.",
    Condition.LOST: "does not know where it is.",
    Condition.SILENT: "no longer responds.",
}
"""Sentences about a robot's new condition."""


def _timed(tick: TickRecord, sentence: str) -> str:
    return f"{tick.tick * TICK:7.1f} s  {sentence}"


def _sentence(utterance: DialogueUtterance) -> str:
    robot = utterance.topic.robot
    person = utterance.seat.capitalize() or "You"
    is_robot = utterance.speaker is Speaker.ROBOT
    speaker = robot_name(robot).capitalize() if is_robot else f"{person} to {robot_name(robot)}"
    wizard = " (said by the researcher)" if utterance.author is Author.WIZARD else ""
    return f"{speaker}{wizard}: {utterance.text}"


def _happened(event: Event, rooms: RoomNames) -> str:
    """Return a sentence about an event. For advice it is empty, because the robot itself says the advice."""

    def titled(room: Room) -> str:
        return rooms.titled(room.people)

    match event:
        case GameStarted(game=game, robots=robots):
            return f"Game {game} begins with {robots} robot{'s' if robots > 1 else ''}."
        case TreasuresHidden(treasures):
            return f"{len(treasures)} treasures are hidden."
        case ConsentGiven():
            return "The participant has agreed to take part."
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
            who = name if by is Commander.RESEARCHER and name else commander_name(by, name)
            return f"{robot_name(robot).capitalize()} is now commanded by {who}."
        case HandbackRequested(robot):
            return f"The participant asks to command {robot_name(robot)} again."
        case TreasureSensed(room, properties):
            what = f"Something {', '.join(map(value_in_words, properties.values()))}".strip()
            return f"{what} is in {titled(room)}."
        case PropertyMeasured(room, robot, name, value):
            return f"{robot_name(robot).capitalize()} senses in {titled(room)}: {_property_in_words(name, value)}."
        case PropertyTold(room, name, value):
            return f"The participant reports from {titled(room)}: {_property_in_words(name, value)}."
        case TreasurePictured(room, robot):
            return f"{robot_name(robot).capitalize()} takes a picture in {titled(room)}."
        case TreasureIdentified(room, _, name, points):
            place = "" if room is None else f" in {titled(room)}"
            named = "named" if name is None else f"named {name_in_words(name)}"
            return f"The treasure{place} is {named}: {points:+d} points."
        case TreasureLeft(room):
            return f"The treasure in {titled(room)} is left undecided."
        case TreasureTakenUp(room):
            return f"The participant considers the treasure in {titled(room)} again."
        case GameEnded(reason, score):
            return f"The game is over: {ENDS[reason]}. Score {score}."


def _property_in_words(name: str, value: str) -> str:
    return f"{name_in_words(name)} {value_in_words(value)}"
