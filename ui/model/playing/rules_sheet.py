"""Rules of the game in sentences, for the help sheet (F1) and for players at a terminal."""

from collections.abc import Iterator, Sequence
from typing import Literal

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.properties import Teller, TreasureProperty
from thbridge.hunt.seats import ONE_SEAT, Seat
from thbridge.roles.shared.view import View
from ui.model.playing.people import robots_of
from ui.model.playing.seat_words import seat_sentences
from ui.model.playing.words import percent


def rules_of(texts: Texts, view: View) -> tuple[str, ...]:
    """Return the rules, with the numbers of a game that the participant may know."""
    # Column 0 is the corridor; robots cannot be sent there.
    moves = [cost for row in view.costs for cost in row[1:] if cost is not None]
    rules = rules_lines(
        texts,
        picture_cost=view.picture_cost,
        identify_cost=view.identify_cost,
        wrong_share=view.wrong_share,
        moves=(min(moves), max(moves)) if moves else None,
        by_position=view.by_position,
        properties=view.properties,
        has_last_word=view.has_last_word,
        seat=ONE_SEAT if view.team is None else view.team.own,
    )
    if view.team is None:
        return rules
    return seat_sentences(texts, view.team.own, robots_of(view, view.team.own, own=True)), *rules


def rules_lines(
    texts: Texts,
    *,
    picture_cost: float,
    identify_cost: float,
    energy: float | None = None,
    wrong_share: float | None = None,
    moves: tuple[float, float] | None = None,
    by_position: bool = False,
    properties: Sequence[TreasureProperty] = (),
    has_last_word: Literal["both", "participant", "robot"] | None = None,
    seat: Seat = ONE_SEAT,
) -> tuple[str, ...]:
    """Return the rules with the numbers of a study, as far as a seat may do and see what they are about.

    Args:
        texts: texts of the players' language.
        picture_cost: energy of a picture.
        identify_cost: energy of naming a treasure.
        energy: energy of each robot at the start; None if unknown.
        wrong_share: share of a treasure's points that a wrong name costs; None if the study does not reveal the share.
        moves: smallest and largest energy of a move between two places; None if unknown.
        by_position: True if the cost of a move depends on the length and the turns of the path from the robot's place;
            `moves` are then the costs between rooms.
        properties: properties of treasures.
        has_last_word: the side that decides in the end if robots argue; None if robots do not argue.
        seat: the seat of the participant.
    """
    start = "" if energy is None else f"{texts.text('rules.start', energy=energy)} "
    decision = () if has_last_word is None else (texts.text(f"rules.decision_of_{has_last_word}"),)
    costs = f"{start}{_costs(texts, picture_cost, identify_cost, moves, by_position=by_position)}"
    return (
        texts.text("rules.goal"),
        costs if seat.sees_energy else texts.text("seats.costs"),
        *_more(texts, properties, seat),
        f"{texts.text('rules.right')} {_wrong(texts, wrong_share)}",
        *decision,
        texts.text("rules.one_visit"),
        texts.text("rules.called_back"),
        texts.text("rules.end" if seat.ends_game else "seats.end"),
    )


def _costs(texts: Texts, picture: float, naming: float, moves: tuple[float, float] | None, *, by_position: bool) -> str:
    if moves is None:
        return texts.text("rules.costs_by_position" if by_position else "rules.costs", picture=picture, naming=naming)
    return texts.text(
        "rules.costs_from_room_to_room" if by_position else "rules.costs_between",
        least=moves[0],
        most=moves[1],
        picture=picture,
        naming=naming,
    )


def _more(texts: Texts, properties: Sequence[TreasureProperty], seat: Seat) -> Iterator[str]:
    """Yield sentences about properties of treasures that a robot does not sense on arrival."""
    measured = [
        texts.clause("rules.sensed_one", property=texts.noun(each.label), cost=each.cost)
        if seat.sees_energy
        else texts.clause("seats.sensed_one", property=texts.noun(each.label))
        for each in properties
        if each.is_measured
    ]
    if measured:
        yield texts.text("rules.sensed" if seat.sees_energy else "seats.sensed", properties=texts.listed(measured))
    told = [
        texts.clause("rules.told_one", property=texts.noun(each.label))
        for each in properties
        if each.told_by is Teller.PERSON and seat.names_treasures
    ]
    if told:
        yield texts.text("rules.told", properties=texts.listed(told))


def _wrong(texts: Texts, share: float | None) -> str:
    match share:
        case None:
            return texts.text("rules.wrong_may_lose")
        case 0.0:
            return texts.text("rules.wrong_loses_none")
        case 1.0:
            return texts.text("rules.wrong_loses_all")
        case _:
            return texts.text("rules.wrong_loses_share", share=percent(texts, share))
