"""Rules of the game in sentences, for the sheet that F1 opens and for players at a terminal."""

from collections.abc import Iterator, Sequence
from typing import Literal

from thbridge.hunt.costs import energy_text
from thbridge.hunt.properties import Teller, TreasureProperty
from thbridge.roles.view import View
from ui.model.playing.words import listed, percent

GOAL = "A treasure lies in each room. Send robots to the rooms, and name what they find."
ONE_VISIT = "A room is visited once by the team. Once you send its robot on, a treasure not named is left for good."
CALLED_BACK = "If you stop a robot, it gets back the energy for the part of the move that it has not driven."
ENDS = (
    "The game ends when every room is visited, or no robot has the energy for another move, and nothing that was found "
    "waits for your decision. You may end it earlier, while no robot is under way."
)
DECIDES = {
    "both": "Robots have reasons of their own; nothing is done before you both agree. You may ask them, and argue.",
    "participant": "Robots advise you and tell their reasons if you ask. The decision is yours.",
    "robot": "Robots decide themselves. You may ask for their reasons, and change their minds.",
}
"""Sentences on who has the last word, where robots argue."""


def rules_of(view: View) -> tuple[str, ...]:
    """The rules with the numbers of a game, as far as its participant is told them."""
    # Column 0 is the corridor, where no robot can be sent.
    moves = [cost for row in view.costs for cost in row[1:] if cost is not None]
    return rules_lines(
        picture_cost=view.picture_cost,
        identify_cost=view.identify_cost,
        wrong_share=view.wrong_share,
        moves=(min(moves), max(moves)) if moves else None,
        by_position=view.by_position,
        properties=view.properties,
        has_last_word=view.has_last_word,
    )


def rules_lines(
    *,
    picture_cost: float,
    identify_cost: float,
    energy: float | None = None,
    wrong_share: float | None = None,
    moves: tuple[float, float] | None = None,
    by_position: bool = False,
    properties: Sequence[TreasureProperty] = (),
    has_last_word: Literal["both", "participant", "robot"] | None = None,
) -> tuple[str, ...]:
    """The rules with the numbers of a study.

    Args:
        picture_cost: energy of a picture.
        identify_cost: energy of naming a treasure.
        energy: of each robot at the start; None where it is not known.
        wrong_share: share of a treasure's points that a wrong name costs; None where it is not told.
        moves: least and most energy of a move between two places; None where it is not known.
        by_position: those are moves between rooms; others cost by where the robot stands.
        properties: of treasures.
        has_last_word: decides in the end where robots argue; None where they do not.
    """
    start = "" if energy is None else f"Each robot starts with {energy_text(energy)} energy. "
    between = ", from room to room" if by_position else ","
    move = "" if moves is None else f"{between} between {energy_text(moves[0])} and {energy_text(moves[1])}"
    work = f"a picture {energy_text(picture_cost)}, naming {energy_text(identify_cost)}"
    return (
        GOAL,
        f"{start}A move costs energy{move}, {work}.",
        *_more(properties),
        f"A right name wins the treasure's points. {_wrong(wrong_share)}",
        *((DECIDES[has_last_word],) if has_last_word else ()),
        ONE_VISIT,
        CALLED_BACK,
        ENDS,
    )


def _more(properties: Sequence[TreasureProperty]) -> Iterator[str]:
    """Sentences on what is found out of a treasure beyond what a robot senses as it finds it."""
    measured = [f"the {each.label.lower()} for {energy_text(each.cost)}" for each in properties if each.is_measured]
    if measured:
        yield f"When you ask for it, a robot senses more of what it found: {listed(measured)} energy."
    told = [f"the {each.label.lower()}" for each in properties if each.told_by is Teller.PERSON]
    if told:
        yield f"What only people can tell, {listed(told)}, you may say once there is a picture. It costs nothing."


def _wrong(share: float | None) -> str:
    match share:
        case None:
            return "A wrong name may lose some."
        case 0.0:
            return "A wrong name loses none."
        case 1.0:
            return "A wrong name loses as many."
        case _:
            return f"A wrong name loses {percent(share)} of them."
