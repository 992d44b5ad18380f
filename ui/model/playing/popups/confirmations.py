"""Questions that ask for confirmation before steps that cannot be undone."""

from thbridge.roles.shared.team_notices import REASONS
from ui.model.playing.keys import question_keys
from ui.model.playing.memory.state import (
    DepartUndecided,
    EndGameEarly,
    HandOverStep,
    HuntMemory,
    LeaveLastTreasure,
    LeaveWindow,
    ObjectionStep,
    ParticipantMemory,
    Reroute,
)
from ui.model.playing.objections import reason_words
from ui.model.playing.people import shown_text
from ui.model.playing.screen import Action, Cancel, Confirm, Confirmation, HandOverTo, ObjectBecause
from ui.model.playing.seat_view import asker_of, label_at_begin, partner_of, sees_energy, sees_score, takers
from ui.model.shared.points import scored


def confirmation(memory: ParticipantMemory, hunt: HuntMemory) -> Confirmation | None:
    """Return the question about the pending step; None if no step is pending."""
    texts, score = hunt.texts, scored(hunt.view.score)
    with_score = sees_score(hunt.view)
    yes, no = (binding.keys[0] for binding in question_keys(texts))
    match hunt.pending_step:
        case Reroute(robot, room):
            return Confirmation(
                texts.text("confirmations.reroute", robot=robot, room=room),
                _reroute_text(memory, hunt, robot, room),
                Action(Confirm(), texts.text("confirmations.reroute_yes", room=room), yes),
                Action(Cancel(), texts.text("confirmations.reroute_no"), no),
            )
        case DepartUndecided(request, room):
            return Confirmation(
                texts.text("confirmations.undecided", room=room),
                texts.text(
                    "confirmations.undecided_text" if hunt.view.team is None else "seats.undecided_text",
                    robot=request.robot,
                    room=room,
                ),
                Action(Confirm(), texts.text("confirmations.undecided_yes"), yes),
                Action(Cancel(), texts.text("confirmations.undecided_no"), no),
            )
        case EndGameEarly():
            left = sum(room.state == "unvisited" for room in hunt.view.rooms)
            return Confirmation(
                texts.text("confirmations.end"),
                texts.text("confirmations.end_text" if with_score else "seats.end_text", count=left, score=score)
                if left
                else texts.text(
                    "confirmations.end_text_all_visited" if with_score else "seats.end_text_all_visited", score=score
                ),
                Action(Confirm(), texts.text("confirmations.end_yes"), yes),
                Action(Cancel(), texts.text("confirmations.end_no"), no),
            )
        case LeaveLastTreasure(room):
            return Confirmation(
                texts.text("confirmations.leave_last"),
                texts.text(
                    "confirmations.leave_last_text" if with_score else "seats.leave_last_text", room=room, score=score
                ),
                Action(Confirm(), texts.text("confirmations.leave_last_yes"), yes),
                Action(Cancel(), texts.text("confirmations.leave_last_no"), no),
            )
        case LeaveWindow(ends):
            return Confirmation(
                texts.text("confirmations.leave_game"),
                texts.text("confirmations.leave_game_ends" if ends else "confirmations.leave_game_goes_on"),
                Action(Confirm(), texts.text("confirmations.leave_game_yes"), yes),
                Action(Cancel(), texts.text("confirmations.leave_game_no"), no),
            )
        case HandOverStep(robot):
            return _who_takes(hunt, robot, yes)
        case ObjectionStep() as step:
            return _why_object(hunt, step, no)
        case None:
            return None


def _who_takes(hunt: HuntMemory, robot: int, yes: str) -> Confirmation:
    """Return the question to whom the participant hands over a robot. A teammate who asks for it comes first."""
    texts, asker = hunt.texts, asker_of(hunt.view, robot)
    seats = sorted(takers(hunt.view), key=lambda seat: seat.name != asker)
    first, *others = [
        Action(HandOverTo(seat.name), label_at_begin(seat.label), str(number) if len(seats) > 1 else yes)
        for number, seat in enumerate(seats, start=1)
    ]
    title, text = texts.text("seats.who_takes", robot=robot), texts.text("seats.who_takes_text")
    no = question_keys(texts)[1].keys[0]
    return Confirmation(title, text, first, Action(Cancel(), texts.text("seats.keep"), no), tuple(others))


def _why_object(hunt: HuntMemory, step: ObjectionStep, no: str) -> Confirmation | None:
    """Return the question for the reason of an objection; None if the dialogue has ended."""
    texts = hunt.texts
    dialogue = next((each for each in hunt.view.dialogues if each.dialogue == step.dialogue), None)
    if dialogue is None:
        return None
    first, *others = [
        Action(ObjectBecause(reason), reason_words(texts, reason), str(number))
        for number, reason in enumerate(REASONS[dialogue.matter], start=1)
    ]
    key = "objections.why_text_because" if step.text else "objections.why_text"
    seat = label_at_begin(partner_of(hunt.view, dialogue))
    text = texts.text(key, seat=seat, words=shown_text(step.text))
    cancel = Action(Cancel(), texts.text("objections.cancel"), no)
    return Confirmation(texts.text("objections.why"), text, first, cancel, tuple(others))


def _reroute_text(memory: ParticipantMemory, hunt: HuntMemory, robot: int, room: int) -> str:
    mover = hunt.view.robots[robot]
    if not sees_energy(hunt.view):
        return hunt.texts.text("seats.reroute_text", robot=robot, place=mover.moving_to or 0, room=room)
    back = hunt.known.state.robots[robot].paid * (1.0 - min(max(memory.motion(robot).progress, 0.0), 1.0))
    return hunt.texts.text(
        "confirmations.reroute_text", robot=robot, place=mover.moving_to or 0, room=room, energy=round(back, 1)
    )
