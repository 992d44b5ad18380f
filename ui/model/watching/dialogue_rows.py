"""Table rows about a dialogue for the researcher's window: moves, beliefs, stores and arguments."""

from collections.abc import Iterator, Mapping, Sequence
from enum import StrEnum

from sim.common.robot_numbers import robot_name
from thbridge.dialogue.portrait import DialoguePortrait, PortrayedArgument
from thbridge.ros.messages.session_records import DialogueMoveRecord
from ui.model.watching.dialogue_log import DialogueCourse

SIDES: Mapping[str, str] = {"robot": "robot", "human": "participant"}
"""Sides of dialogues, in words for people."""


class DialogueList(StrEnum):
    """List about a dialogue; a researcher selects one of these lists."""

    ARGUMENTS = "Arguments"
    BELIEFS = "Beliefs of the robot (Σ)"
    PICTURE = "Robot's picture of the participant (Γ)"
    ROBOT_STORE = "Said by the robot"
    HUMAN_STORE = "Said by the participant"


def heading(robot: int, course: DialogueCourse) -> str:
    """Return a line with the topic and the state of a robot's latest dialogue."""
    name = robot_name(robot).capitalize()
    if not course.moves:
        return f"{name} has not argued yet."
    *_, (_, last) = course.moves
    game = next((each for each in course.portrait.games if each.number == last.dialogue), None)
    if game is None:
        return f"{name}, dialogue {last.talk} ({last.after}): {last.game}"
    opener = SIDES.get(game.opener, game.opener)
    stands = game.end or last.after
    return f"{name}, dialogue {last.talk} ({stands}): {game.game} about {game.topic}, opened by the {opener}"


def move_row(move: DialogueMoveRecord) -> tuple[str, str, str, str]:
    """Return the cells of a move: the speaker, the move, its sentence, and the states before and after it."""
    who = "wizard" if move.author == "wizard" else SIDES.get(move.speaker, move.speaker)
    inside = "  within " + str(move.parent) + ": " if move.parent else ""
    notes = " (automatic)" if move.is_booked else ""
    heard = f" The robot understood: {move.heard}" if move.heard else ""
    written = f"{move.locution}{move.content}" if move.content.startswith("({") else f"{move.locution}({move.content})"
    return who, f"{inside}{written}{notes}", f"{move.text}{heard}", f"{move.before} → {move.after}"


def rows(shown: DialogueList, portrait: DialoguePortrait) -> Iterator[tuple[str, str, str]]:
    """Yield the rows of a list; each row has three cells."""
    match shown:
        case DialogueList.ARGUMENTS:
            for place, argument in enumerate(portrait.arguments):
                yield _argument(place, argument, portrait)
        case DialogueList.BELIEFS:
            for belief in portrait.sigma:
                yield belief.literal, belief.source, f"at {belief.at:.1f} s, confidence {belief.confidence:.2f}"
            yield from ((rule, "rule", "") for rule in portrait.rules)
        case DialogueList.PICTURE:
            argued = set(portrait.argued)
            yield from ((held, "believed", "with an argument" if held in argued else "") for held in portrait.held)
            yield from ((unknown, "unknown", "") for unknown in portrait.unknown)
            yield from ((each, "", "with an argument") for each in portrait.argued if each not in portrait.held)
        case DialogueList.ROBOT_STORE:
            yield from ((move, "", "") for move in portrait.robot_store)
        case DialogueList.HUMAN_STORE:
            yield from ((move, "", "") for move in portrait.human_store)


def describe_attacks(portrait: DialoguePortrait) -> str:
    """Return a description of the graph of arguments for people who do not see it: arguments, attacks, acceptance."""
    return " ".join(
        ". ".join(part for part in _argument(place, argument, portrait) if part) + "."
        for place, argument in enumerate(portrait.arguments)
    )


def _argument(place: int, argument: PortrayedArgument, portrait: DialoguePortrait) -> tuple[str, str, str]:
    stands = "accepted" if place in portrait.grounded else "not accepted"
    attackers = [one for one, other in portrait.attacks if other == place]
    attacked = f"attacked by {_numbers(attackers)}" if attackers else "not attacked"
    because = f"because {', '.join(argument.support)}" if argument.support else ""
    return f"{place + 1}: {argument.conclusion}", because, "; ".join((holders(argument), stands, attacked))


def holders(argument: PortrayedArgument) -> str:
    """Return the sides that believe all parts of an argument; for an objection, the seat.

    If neither side believes all parts, return "each side in part".
    """
    return " and ".join(SIDES.get(side, side) for side in argument.sides) or "each side in part"


def _numbers(places: Sequence[int]) -> str:
    return ", ".join(str(place + 1) for place in places)
