"""Pop-up of a dialogue between a robot and the participant."""

from sim.common.robot_numbers import robot_name
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.view import DialogueView, SelectRoom
from ui.model.keys import choice_keys, keyed
from ui.model.playing.memory.history import SpokenLine, spoken
from ui.model.playing.memory.popup_queue import DestinationItem
from ui.model.playing.memory.state import HuntMemory
from ui.model.playing.possible import energy_warning
from ui.model.playing.words import name_request, titled
from ui.model.screen import Action, DialoguePopup, GiveAnswer, ShowNext


def destination_popup(hunt: HuntMemory, item: DestinationItem) -> DialoguePopup | None:
    """The dialogue about where a robot shall go; before the robot answers, the pending request."""
    dialogue = hunt.destination_dialogue(item.robot)
    asked = hunt.pending.destination_request(item.robot)
    if asked is not None:
        about = f" about room {asked.room}" if isinstance(asked, SelectRoom) else " for its advice"
        never_mind = keyed(ShowNext(), "Never mind", hint="Do not ask it.")
        sentences = _request(hunt, item.robot)
        title = f"Asking {robot_name(item.robot)}{about} …"
        room = asked.room if isinstance(asked, SelectRoom) else None
        return DialoguePopup(item.robot, title, sentences, (), never_mind, room=room)
    return None if dialogue is None else dialogue_popup(hunt, dialogue)


def dialogue_popup(hunt: HuntMemory, dialogue: DialogueView) -> DialoguePopup:
    """A dialogue that waits for the participant, or for the robot once they have answered."""
    answered = hunt.pending.answer(dialogue.dialogue, dialogue.turn)
    sentences = list(spoken(dialogue))
    opening = _opening(hunt, dialogue)
    if opening:
        # Robots that argue repeat it as the first move.
        sentences[:1] = [*opening, *(line for line in sentences[:1] if line[0] == "robot")]
    if answered is not None and answered < len(dialogue.choices):
        sentences.append(("you", dialogue.choices[answered]))
    choices = tuple(
        Action(GiveAnswer(number), text, key, enabled=answered is None, pending=number == answered)
        for number, (text, key) in enumerate(zip(dialogue.choices, choice_keys(dialogue.choices), strict=True))
    )
    later = keyed(ShowNext(), "Later", hint="The robot waits for your answer.")
    mind = energy_warning(hunt.known, dialogue.robot, dialogue.room) if dialogue.matter == "select-room" else ""
    title = dialogue_title(hunt, dialogue)
    return DialoguePopup(dialogue.robot, title, tuple(sentences), choices, later, mind, dialogue.room)


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
