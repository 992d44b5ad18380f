"""Pop-up of a dialogue between a robot and the participant."""

from collections.abc import Sequence
from dataclasses import replace

from thbridge.roles.shared.view import DialogueView, LastWords, SelectRoom
from ui.model.playing.keys import BACK, WAITING_KEY, choice_keys, keyed
from ui.model.playing.memory.history import SpokenLine, says, spoken
from ui.model.playing.memory.popup_queue import DestinationItem
from ui.model.playing.memory.state import HuntMemory
from ui.model.playing.objections import object_button, with_objections
from ui.model.playing.possible import energy_warning
from ui.model.playing.screen import Action, AnswerDialogueAct, DialoguePopup, ShowNext
from ui.model.playing.seat_view import is_own, partner_of
from ui.model.playing.words import MATTERS, outcome_of

OVERRIDE = "override"
"""Name of the answer by which the participant decides against the robot's advice."""
LAST_SENTENCES = 2
"""Number of sentences of an ended dialogue that are shown.

The number is small, because the robot already moves on the map behind the pop-up.
"""


def destination_popup(hunt: HuntMemory, item: DestinationItem) -> DialoguePopup | None:
    """Return the pop-up of a dialogue about a robot's next room.

    Before the robot answers, the pop-up shows the pending request; after the dialogue, the end of the dialogue.
    """
    dialogue = hunt.destination_dialogue(item.robot)
    asked = hunt.pending.destination_request(item.robot)
    if asked is not None:
        texts, room = hunt.texts, asked.room if isinstance(asked, SelectRoom) else None
        never_mind = keyed(ShowNext(), texts.text("popups.never_mind"), hint=texts.text("popups.never_mind_hint"))
        sentences = _request(hunt, item.robot)
        title = (
            texts.text("popups.asking_advice", robot=item.robot)
            if room is None
            else texts.text("popups.asking_about", robot=item.robot, room=room)
        )
        return DialoguePopup(item.robot, title, sentences, (), never_mind, room=room)
    if dialogue is not None:
        return dialogue_popup(hunt, dialogue)
    words = hunt.unread_words(item.robot)
    return None if words is None else _last_words_popup(hunt, words)


def dialogue_popup(hunt: HuntMemory, dialogue: DialogueView) -> DialoguePopup:
    """Return the pop-up of a dialogue that waits for the participant or, after an answer, for the robot."""
    texts, argues = hunt.texts, hunt.view.has_last_word is not None
    if not is_own(hunt.view, dialogue.robot, dialogue.matter):
        return _followed(hunt, dialogue)
    acts = dialogue.acts if argues else ()
    answered = hunt.pending.answer(dialogue.dialogue, dialogue.turn)
    sentences: list[SpokenLine] = [*with_objections(texts, hunt.view, dialogue, spoken(dialogue))]
    opening = _opening(hunt, dialogue)
    if opening:
        # Robots that argue repeat the participant's sentence as the first move.
        sentences[:1] = [*opening, *(line for line in sentences[:1] if line[0] != "you")]
    if answered is not None and says(dialogue, answered):
        sentences.append(("you", dialogue.choices[answered]))
    keys = choice_keys(dialogue.choices, acts)
    choices = tuple(
        Action(
            AnswerDialogueAct(number),
            text,
            keys[number],
            enabled=answered is None,
            hint=texts.text("popups.your_decision") if acts[number : number + 1] == (OVERRIDE,) else "",
            pending=number == answered,
        )
        for number, text in enumerate(dialogue.choices)
    )
    later = keyed(ShowNext(), texts.text("popups.later"), hint=texts.text("popups.answer_later_hint"))
    return DialoguePopup(
        dialogue.robot,
        dialogue_title(hunt, dialogue),
        tuple(sentences),
        choices,
        # Esc is the key that closes the questions, so only W puts the pop-up aside.
        replace(later, key=WAITING_KEY) if BACK in acts else later,
        warning=_warning(hunt, dialogue),
        room=dialogue.room,
        note=_note(hunt, dialogue, sentences) if argues and answered is None else "",
        numbered=argues,
    )


def _followed(hunt: HuntMemory, dialogue: DialogueView) -> DialoguePopup:
    """Return the pop-up of a dialogue of a teammate, without answers."""
    texts, partner, objects = hunt.texts, partner_of(hunt.view, dialogue), object_button(hunt, dialogue)
    writes = objects is not None and objects.enabled and hunt.view.team is not None and hunt.view.team.talk_is_open
    return DialoguePopup(
        dialogue.robot,
        dialogue_title(hunt, dialogue),
        with_objections(texts, hunt.view, dialogue, spoken(dialogue, own=False)),
        (),
        keyed(ShowNext(), texts.text("popups.close")),
        room=dialogue.room,
        note=texts.text("seats.talks_with", seat=partner, robot=dialogue.robot) if partner else "",
        partner=partner or hunt.view.robots[dialogue.robot].commander_name,
        objects=objects,
        own_words=texts.text("objections.own_words") if writes else "",
    )


def _note(hunt: HuntMemory, dialogue: DialogueView, sentences: Sequence[SpokenLine]) -> str:
    """Return a remark about the decision.

    The remark says which side decides in the end, or that the participant must answer although the robot is silent.
    """
    last = next((speaker for speaker, _ in reversed(sentences) if speaker != "objection"), "")
    if last == "you" and BACK not in dialogue.acts:
        return hunt.texts.text("popups.your_turn", robot=dialogue.robot)
    return hunt.texts.text(f"popups.decision_of_{hunt.view.has_last_word}", robot=dialogue.robot)


def _warning(hunt: HuntMemory, dialogue: DialogueView) -> str:
    is_about_moving = dialogue.matter == "select-room"
    return energy_warning(hunt.texts, hunt.known, dialogue.robot, dialogue.room) if is_about_moving else ""


def _last_words_popup(hunt: HuntMemory, words: LastWords) -> DialoguePopup:
    """Return the pop-up with the end of a dialogue about a robot's next room."""
    texts, own = hunt.texts, is_own(hunt.view, words.robot, words.matter)
    sentences = with_objections(texts, hunt.view, words, spoken(words, own=own))[-LAST_SENTENCES:]
    outcome = "" if words.is_told else outcome_of(texts, words)
    if not sentences:
        outcome = f"{outcome} {texts.text('popups.said_before')}".lstrip()
    close = keyed(ShowNext(), texts.text("popups.close"))
    title = texts.text("popups.about_room", robot=words.robot, room=words.room)
    partner = "" if own else hunt.view.robots[words.robot].commander_name
    return DialoguePopup(
        words.robot, title, sentences, (), close, room=words.room, ended=True, outcome=outcome, partner=partner
    )


def dialogue_title(hunt: HuntMemory, dialogue: DialogueView) -> str:
    """Return the title of a dialogue, which names the subject."""
    named = hunt.submitted_names.get(dialogue.room) if dialogue.matter == "take-treasure" else None
    if named:
        return hunt.texts.text("popups.about_name", robot=dialogue.robot, name=hunt.view.word_for(named))
    about = MATTERS[dialogue.matter]
    return hunt.texts.text(f"popups.about_{about}", robot=dialogue.robot, room=dialogue.room)


def _opening(hunt: HuntMemory, dialogue: DialogueView) -> tuple[SpokenLine, ...]:
    """Return the sentence with which the participant opened this dialogue in this window, or nothing."""
    named = hunt.submitted_names.get(dialogue.room)
    if dialogue.matter == "select-room":
        return _request(hunt, dialogue.robot)
    if dialogue.matter != "take-treasure" or not named:
        return ()
    return (("you", hunt.texts.text("popups.say_name", name=hunt.view.word_for(named))),)


def _request(hunt: HuntMemory, robot: int) -> tuple[SpokenLine, ...]:
    """Return the sentence with which the participant opened the dialogue in this window, or nothing."""
    sentence = hunt.opening_sentences.get(robot)
    return () if sentence is None else (("you", sentence),)
