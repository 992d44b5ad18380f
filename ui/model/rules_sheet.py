"""Rules of the game in sentences, for the sheet that F1 opens."""

from thbridge.hunt.costs import energy_text

GOAL = "A treasure lies in each room. Send robots to the rooms, and name what they find."
ONE_VISIT = "A room is visited once by the team. Once its robot sets out again, a treasure not named is left for good."
CALLED_BACK = "A robot that is stopped gets the energy for the rest of its way back."
ENDS = (
    "The game ends when every room is visited, or no robot has the energy for another move, and nothing that was found "
    "waits for your decision."
)


def rules_lines(
    *,
    picture_cost: float,
    identify_cost: float,
    energy: float | None = None,
    wrong_share: float | None = None,
    moves: tuple[float, float] | None = None,
) -> tuple[str, ...]:
    """The rules with the numbers of a study.

    Args:
        picture_cost: energy of a picture.
        identify_cost: energy of naming a treasure.
        energy: of each robot at the start; None where it is not known.
        wrong_share: share of a treasure's points that a wrong name costs; None where it is not known.
        moves: least and most energy of a move between two places; None where it is not known.
    """
    start = "" if energy is None else f"Each robot starts with {energy_text(energy)} energy. "
    move = "" if moves is None else f", between {energy_text(moves[0])} and {energy_text(moves[1])}"
    work = f"a picture {energy_text(picture_cost)}, naming {energy_text(identify_cost)}"
    return (
        GOAL,
        f"{start}A move costs energy{move}, {work}.",
        f"A right name wins the treasure's points. {_wrong(wrong_share)}",
        ONE_VISIT,
        CALLED_BACK,
        ENDS,
    )


def _wrong(share: float | None) -> str:
    if share is None:
        return "A wrong name may lose some."
    if share == 0.0:
        return "A wrong name loses none."
    return "A wrong name loses as many." if share == 1.0 else f"A wrong name loses {share:.0%} of them."
