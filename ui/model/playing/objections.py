"""Objections in dialogues of several participants: sentences about them, and the participant's own objection."""

from collections.abc import Iterator, Sequence

from thbridge.dialogue.wording.texts import Texts
from thbridge.hunt.events import ObjectionReason
from thbridge.roles.shared.team_notices import ObjectionView, RaiseObjection
from thbridge.roles.shared.view import DialogueView, LastWords, View, objections_of
from ui.model.playing.keys import OBJECT
from ui.model.playing.memory.history import SpokenLine
from ui.model.playing.memory.state import HuntMemory
from ui.model.playing.people import shown_text
from ui.model.playing.screen import Action, RaiseObjectionAct
from ui.model.playing.seat_view import has_objected, is_by_own, is_own, label_at_begin, label_of, partner_of


def reason_words(texts: Texts, reason: ObjectionReason) -> str:
    """Return a reason as a sentence."""
    return texts.text(f"objections.{reason.value.replace('-', '_')}")


def objection_words(texts: Texts, view: View, objection: ObjectionView) -> str:
    """Return an objection as a sentence that says who objects, and why."""
    key = "objections.by_you" if is_by_own(view, objection) else "objections.by_teammate"
    key += "_because" if objection.text else ""
    seat, reason = label_at_begin(label_of(view, objection.seat)), reason_words(texts, objection.reason)
    return texts.text(key, seat=seat, reason=reason, words=shown_text(objection.text))


def with_objections(
    texts: Texts, view: View, dialogue: DialogueView | LastWords, sentences: Sequence[SpokenLine]
) -> tuple[SpokenLine, ...]:
    """Return the sentences of a dialogue, with the objections at the places where they were raised."""
    raised = [each for each in objections_of(view) if each.dialogue == dialogue.dialogue]
    lines: list[SpokenLine] = []
    for at in range(len(sentences) + 1):
        lines += [("objection", objection_words(texts, view, each)) for each in raised if each.after == at]
        lines += sentences[at : at + 1]
    return tuple(lines)


def new_objections(before: View, view: View) -> Iterator[ObjectionView]:
    """Yield the objections that are new in a view."""
    known = objections_of(before)
    return (each for each in objections_of(view) if each not in known)


def robot_of(view: View, objection: ObjectionView) -> int | None:
    """Return the robot of an objection's dialogue, or None if the view does not contain the dialogue."""
    talks: list[DialogueView | LastWords] = [*view.dialogues, *view.last_words]
    return next((each.robot for each in talks if each.dialogue == objection.dialogue), None)


def can_object(view: View, dialogue: DialogueView) -> bool:
    """Return True if a dialogue is a teammate's, and the participant's seat may object in such dialogues."""
    team = view.team
    return team is not None and team.own.may_object and not is_own(view, dialogue.robot, dialogue.matter)


def object_button(hunt: HuntMemory, dialogue: DialogueView) -> Action | None:
    """Return the button to object in a dialogue of a teammate; None if the participant's seat may not object."""
    if not can_object(hunt.view, dialogue):
        return None
    seat, done = label_at_begin(partner_of(hunt.view, dialogue)), has_objected(hunt.view, dialogue.dialogue)
    pending = (each for each in hunt.pending.requests if isinstance(each, RaiseObjection))
    busy = any(each.dialogue == dialogue.dialogue for each in pending)
    hint = hunt.texts.text("objections.have_objected" if done else "objections.hint", seat=seat)
    label = hunt.texts.text("objections.object")
    return Action(RaiseObjectionAct(), label, OBJECT.keys[0], not (done or busy), hint, busy)
