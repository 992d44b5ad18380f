"""Rights and teammates of a participant, from the view of the seat. In a game with one participant, nothing is hidden
and there are no teammates."""

from collections.abc import Iterator

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.seats import Seat
from thbridge.roles.shared.participant_rules import Situation
from thbridge.roles.shared.seat_rights import why_not_allowed
from thbridge.roles.shared.team_notices import DecisionView, ObjectionView
from thbridge.roles.shared.view import DialogueMatter, DialogueView, ParticipantRequest, View, objections_of


def sees_energy(view: View) -> bool:
    """Return True if the participant sees the robots' energy and the costs of moves."""
    return view.team is None or view.team.own.sees_energy


def sees_score(view: View) -> bool:
    """Return True if the participant sees the score and the points of treasures."""
    return view.team is None or view.team.own.sees_score


def sees_map(view: View) -> bool:
    """Return True if the participant sees the map."""
    return view.team is None or view.team.own.sees_map


def may_name(view: View) -> bool:
    """Return True if the participant may name treasures, and leave them."""
    return view.team is None or view.team.own.names_treasures


def is_own(view: View, robot: int, matter: DialogueMatter) -> bool:
    """Return True if a dialogue with a robot about a matter is the participant's, not a teammate's."""
    if view.team is None:
        return True
    if matter == "take-treasure":
        return view.team.own.names_treasures
    return not view.robots[robot].has_other_commander


def partner_of(view: View, dialogue: DialogueView) -> str:
    """Return the label of the teammate who talks with a robot; empty if it is the participant, or if it is unknown."""
    partners = () if view.team is None else view.team.partners
    return label_of(view, next((seat for number, seat in partners if number == dialogue.dialogue), ""))


def label_of(view: View, seat: str) -> str:
    """Return the label of a seat; empty if there is none with this name."""
    return next((each.label for each in _seats(view) if each.name == seat), "")


def label_at_begin(label: str) -> str:
    """Return the label of a seat for the beginning of a sentence."""
    return label[:1].upper() + label[1:]


def takers(view: View) -> tuple[Seat, ...]:
    """Return the teammates to whom the participant can hand over a robot."""
    return tuple(seat for seat in _seats(view)[1:] if seat.can_take_over)


def asker_of(view: View, robot: int) -> str:
    """Return the name of the seat that asks for a robot of the participant; empty if there is none."""
    asked = () if view.team is None else view.team.asked_for
    return next((seat for number, seat in asked if number == robot), "")


def decisions(view: View) -> tuple[DecisionView, ...]:
    """Return the open votes."""
    return () if view.team is None else view.team.decisions


def decision_about(view: View, *, robot: int | None = None, room: int | None = None) -> DecisionView | None:
    """Return the open vote on sending a robot, on the name of a treasure in a room or, without both, on the end."""
    kind = "send" if robot is not None else "name" if room is not None else "end"
    fitting = (each for each in decisions(view) if each.kind == kind)
    return next((each for each in fitting if robot in (None, each.robot) and room in (None, each.room)), None)


def only_others(texts: Texts, known: Situation, request: ParticipantRequest) -> str | None:
    """Return a sentence that names the seats which may send a request, if the participant's seat may not.

    Return None if it may, or if the reason is not a right of the seat.
    """
    seat, state = known.seat, known.state
    if seat is None or why_not_allowed(state, seat, request) is None:
        return None
    able = [each.label for each in state.started.seats if why_not_allowed(state, each, request) is None]
    if not able:
        return texts.text("seats.nobody_may")
    return texts.text("seats.only", seats=either(texts, able))


def either(texts: Texts, things: list[str]) -> str:
    """Return things as a list of alternatives: `the driver, the namer or the judge`."""
    *others, last = things
    return f"{texts.forms.between.join(others)}{texts.text('seats.or')}{last}" if others else last


def _seats(view: View) -> list[Seat]:
    team = view.team
    return [] if team is None else [team.own, *(mate.seat for mate in team.teammates)]


def teammates_who_name(view: View) -> Iterator[str]:
    """Yield the labels of the teammates who may name treasures."""
    return (seat.label for seat in _seats(view)[1:] if seat.names_treasures)


def is_by_own(view: View, objection: ObjectionView) -> bool:
    """Return True if an objection is the participant's."""
    return view.team is not None and view.team.own.name == objection.seat


def has_objected(view: View, dialogue: int) -> bool:
    """Return True if the participant has objected in a dialogue."""
    return any(each.dialogue == dialogue and is_by_own(view, each) for each in objections_of(view))
