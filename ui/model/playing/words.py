"""Words that several modules use."""

import re

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.events import Commander
from thbridge.hunt.seats import Seat
from thbridge.roles.shared.view import DialogueMatter, LastWords

MATTERS: dict[DialogueMatter, str] = {"select-room": "room", "take-picture": "picture", "take-treasure": "naming"}
"""Names of the matters of dialogues, as used in the keys of texts."""


_NUMBERED_STATION = re.compile(r"ground station (\d+)")
"""Pattern of the names that `thbridge.mavlink` gives to ground stations without a name."""


def commander_in_words(texts: Texts, by: Commander, name: str) -> str:
    """Return the name of a commander other than the participant, for use within a sentence.

    Names of researchers' programs are omitted.
    """
    match by:
        case Commander.PARTICIPANT:
            return ""
        case Commander.GROUND_STATION if numbered := _NUMBERED_STATION.fullmatch(name):
            return texts.clause("words.numbered_station", number=numbered[1])
        case Commander.GROUND_STATION:
            return name or texts.text("words.ground_station")
        case Commander.RESEARCHER:
            return texts.text("words.researcher")
        case Commander.TEAMMATE:
            return name


def how_it_comes_back(texts: Texts, commander: Commander, seat: Seat | None = None) -> str:
    """Return a sentence that says how the participant gets a robot from a commander.

    Args:
        texts: texts of the game's language.
        commander: the commander.
        seat: seat of the participant; None in a game with one participant.
    """
    if commander is Commander.TEAMMATE:
        return texts.text("seats.ask_for_it" if seat is None or seat.can_take_over else "seats.not_yours")
    is_researcher = commander is Commander.RESEARCHER
    return texts.text("hints.back_from_researcher" if is_researcher else "hints.back_from_station")


def commanded_words(texts: Texts, robot: int, by: Commander, name: str, seat: Seat | None = None) -> str:
    """Return two sentences: which commander a robot has, and how the participant gets the robot.

    `seat` is the seat of the participant; None in a game with one participant.
    """
    commands = texts.text("hints.commanded", robot=robot, commander=commander_in_words(texts, by, name))
    return f"{commands} {how_it_comes_back(texts, by, seat)}"


def progress_of(texts: Texts, seconds: int, left: int, rooms: int) -> str:
    """Return the time played and rooms left: `Time 3:05 · 5 of 8 rooms left`."""
    return texts.text("game.progress", time=clock_words(seconds), left=left, count=rooms)


def clock_words(seconds: int) -> str:
    """Return a time of the game: `3:05`."""
    return f"{seconds // 60}:{seconds % 60:02d}"


def percent(texts: Texts, share: float) -> str:
    """Return a share as a percentage: `50%`, `12.5%`."""
    return texts.text("words.percent", number=100.0 * share)


def verdict_words(texts: Texts, name: str, points: int, *, shows_points: bool = True) -> str:
    """Return the result of naming a treasure as a sentence, with the name in the participant's language.

    If `shows_points` is False, the sentence does not say whether the name is right.
    """
    if not shows_points:
        return texts.text("seats.named", name=name) if name else texts.text("seats.named_silently")
    named = name or texts.text("popups.nameless")
    if points > 0:
        return texts.text("popups.right", name=named, count=points)
    if points < 0:
        return texts.text("popups.wrong", name=named, count=-points)
    return texts.text("popups.no_points", name=named)


def outcome_of(texts: Texts, words: LastWords) -> str:
    """Return the result of a dialogue as a sentence."""
    outcome = "agreed" if words.agreed else "not_agreed"
    return texts.text(f"popups.{outcome}_{MATTERS[words.matter]}", robot=words.robot, room=words.room)
