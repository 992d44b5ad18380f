"""Pop-up of a dialogue between a robot and the participant."""

from collections.abc import Sequence
from dataclasses import replace

from sim.common.robot_numbers import robot_name
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.view import DialogueView, LastWords, SelectRoom
from ui.model.keys import BACK, WAITING_KEY, choice_keys, keyed
from ui.model.playing.memory.history import SpokenLine, says, spoken
from ui.model.playing.memory.popup_queue import DestinationItem
from ui.model.playing.memory.state import HuntMemory
from ui.model.playing.possible import energy_warning
from ui.model.playing.words import name_request, outcome_of, titled
from ui.model.screen import Action, DialoguePopup, GiveAnswer, ShowNext

OVERRIDE = "override"
"""Word for the answer with which the participant decides against the robot's advice."""
LAST_SENTENCES = 2
"""Sentences of a dialogue that are shown once it has ended: the robot moves on the map meanwhile."""


def destination_popup(hunt: HuntMemory, item: DestinationItem) -> DialoguePopup | None:
    """The dialogue about where a robot shall go; before the robot answers, the pending request.

    Once it has ended, its end.
    """
    dialogue = hunt.destination_dialogue(item.robot)
    asked = hunt.pending.destination_request(item.robot)
    if asked is not None:
        about = f" about room {asked.room}" if isinstance(asked, SelectRoom) else " for its advice"
        never_mind = keyed(ShowNext(), "Never mind", hint="Do not ask it.")
        sentences = _request(hunt, item.robot)
        title = f"Asking {robot_name(item.robot)}{about} …"
        room = asked.room if isinstance(asked, SelectRoom) else None
        return DialoguePopup(item.robot, title, sentences, (), never_mind, room=room)
    if dialogue is not None:
        return dialogue_popup(hunt, dialogue)
    words = hunt.unread_words(item.robot)
    return None if words is None else _last_words_popup(words)


def dialogue_popup(hunt: HuntMemory, dialogue: DialogueView) -> DialoguePopup:
    """A dialogue that waits for the participant, or for the robot once they have answered."""
    argues = hunt.view.has_last_word is not None
    acts = dialogue.acts if argues else ()
    answered = hunt.pending.answer(dialogue.dialogue, dialogue.turn)
    sentences = list(spoken(dialogue))
    opening = _opening(hunt, dialogue)
    if opening:
        # Robots that argue repeat it as the first move.
        sentences[:1] = [*opening, *(line for line in sentences[:1] if line[0] == "robot")]
    if answered is not None and says(dialogue, answered):
        sentences.append(("you", dialogue.choices[answered]))
    keys = choice_keys(dialogue.choices, acts)
    choices = tuple(
        Action(
            GiveAnswer(number),
            text,
            keys[number],
            enabled=answered is None,
            hint="This is your decision." if acts[number : number + 1] == (OVERRIDE,) else "",
            pending=number == answered,
        )
        for number, text in enumerate(dialogue.choices)
    )
    later = keyed(ShowNext(), "Later", hint="The robot waits for your answer.")
    return DialoguePopup(
        dialogue.robot,
        dialogue_title(hunt, dialogue),
        tuple(sentences),
        choices,
        # Esc leads back from the questions, and W does what it does elsewhere.
        replace(later, key=WAITING_KEY) if BACK in acts else later,
        warning=energy_warning(hunt.known, dialogue.robot, dialogue.room) if dialogue.matter == "select-room" else "",
        room=dialogue.room,
        note=_note(hunt, dialogue, sentences) if argues and answered is None else "",
        numbered=argues,
    )


def _note(hunt: HuntMemory, dialogue: DialogueView, sentences: Sequence[SpokenLine]) -> str:
    """A remark: who decides in the end, or that it is the participant's turn although the robot says nothing."""
    name = titled(dialogue.robot)
    if sentences[-1][0] == "you" and BACK not in dialogue.acts:
        return f"{name} has nothing to add. It is your turn."
    match hunt.view.has_last_word:
        case "participant":
            return f"{name} advises you. The decision is yours."
        case "robot":
            return f"{name} decides in the end. You may change its mind."
        case _:
            return "Nothing is done before you both agree."


def _last_words_popup(words: LastWords) -> DialoguePopup:
    """The end of a dialogue about where a robot goes."""
    outcome, sentences = "" if words.is_told else outcome_of(words), spoken(words)[-LAST_SENTENCES:]
    if not sentences:
        outcome += " You have talked about that before, and it has nothing to add."
    close = keyed(ShowNext(), "Close")
    title = f"{titled(words.robot)}: go to room {words.room}?"
    return DialoguePopup(words.robot, title, sentences, (), close, room=words.room, ended=True, outcome=outcome)


def dialogue_title(hunt: HuntMemory, dialogue: DialogueView) -> str:
    """Title of a dialogue: its subject."""
    name = titled(dialogue.robot)
    match dialogue.matter:
        case "select-room":
            return f"{name}: go to room {dialogue.room}?"
        case "take-picture":
            return f"{name}: take a picture in room {dialogue.room}?"
        case "take-treasure":
            named = hunt.submitted_names.get(dialogue.room)
            what = f"it {name_in_words(named)}" if named else f"what is in room {dialogue.room}"
            return f"{name}: name {what}?"


def _opening(hunt: HuntMemory, dialogue: DialogueView) -> tuple[SpokenLine, ...]:
    """The sentence with which the participant opened this dialogue, if they did so here."""
    named = hunt.submitted_names.get(dialogue.room)
    if dialogue.matter == "select-room":
        return _request(hunt, dialogue.robot)
    return (("you", name_request(named)),) if dialogue.matter == "take-treasure" and named else ()


def _request(hunt: HuntMemory, robot: int) -> tuple[SpokenLine, ...]:
    """The sentence with which the participant opened the dialogue; none if they did so in another window."""
    sentence = hunt.opening_sentences.get(robot)
    return () if sentence is None else (("you", sentence),)
