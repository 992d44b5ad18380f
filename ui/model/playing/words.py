"""Phrases that several parts share."""

from collections.abc import Sequence

from sim.common.robot_numbers import robot_name
from thbridge.hunt.events import Commander
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.view import LastWords


def titled(robot: int) -> str:
    """A robot's name at the beginning of a sentence."""
    return robot_name(robot).capitalize()


def how_it_comes_back(commander: Commander) -> str:
    """A sentence: the condition for getting back a robot that this other commander has."""
    researcher = commander is Commander.RESEARCHER
    return f"You get it back when the {'researcher is done' if researcher else 'ground station releases it'}."


def place_name(place: int) -> str:
    """Name of a place within a sentence."""
    return "the corridor" if place == 0 else f"room {place}"


def counted(number: int, thing: str) -> str:
    """`1 point`, `2 points`, `no points`."""
    return f"{number or 'no'} {thing}{'' if number == 1 else 's'}"


def listed(things: Sequence[str]) -> str:
    """`a`, `a and b`, `a, b and c`."""
    return things[-1] if len(things) < 2 else f"{', '.join(things[:-1])} and {things[-1]}"


def progress_of(seconds: int, left: int, rooms: int) -> str:
    """Time played and rooms left: `Time 3:05 · 5 of 8 rooms left`."""
    return f"Time {seconds // 60}:{seconds % 60:02d} · {left} of {counted(rooms, 'room')} left"


def scored(score: int) -> str:
    """A score with the typographer's minus: `20`, `−20`."""
    return f"{score}".replace("-", "−")


def gained(points: int) -> str:
    """Points won or lost: `+20`, `−20`."""
    return f"{points:+d}".replace("-", "−")


def percent(share: float) -> str:
    """A share as people write it: `50%`, `12.5%`."""
    return f"{100.0 * share:.6g}%"


def name_request(name: str) -> str:
    """The sentence with which the participant asks for a treasure to be named."""
    return f"Name it {name_in_words(name)}."


UNSURE_NAME = "I don't know what it is."
"""The sentence with which the participant asks a robot what it has found."""


def verdict_words(name: str, points: int) -> str:
    """The outcome of naming a treasure, as a sentence."""
    named = name_in_words(name) or "That"
    if points > 0:
        return f"{named} is right, {counted(points, 'point')} won."
    if points < 0:
        return f"{named} is wrong, {counted(-points, 'point')} lost."
    return f"{named} brings no points."


def outcome_of(words: LastWords) -> str:
    """The outcome of a dialogue, as a sentence."""
    name = titled(words.robot)
    match words.matter, words.agreed:
        case "select-room", True:
            return f"{name} goes to room {words.room}."
        case "take-picture", True:
            return f"{name} takes a picture in room {words.room}."
        case "take-treasure", True:
            return f"{name} names what is in room {words.room}."
        case "select-room", False:
            return f"{name} stays where it is."
        case "take-picture", False:
            return f"{name} takes no picture in room {words.room}."
        case _:
            return f"{name} does not name what is in room {words.room}."


def as_sentence(text: str) -> str:
    """The text with a capital letter at its beginning and a full stop at its end."""
    return text[:1].upper() + text[1:] + ("" if not text or text[-1] in ".?!…" else ".")
