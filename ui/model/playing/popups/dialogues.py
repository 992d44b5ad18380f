"""The pop-up in which a robot talks with the participant."""

from typing import Literal

from thbridge.hunt.rules import robot_name
from thbridge.roles.view import DialogueView, Select
from ui.model.keys import choice_keys, key_of
from ui.model.playing.history import speaker_of
from ui.model.playing.popup_queue import DestinationItem
from ui.model.playing.possible import energy_warning
from ui.model.playing.state import HuntMemory
from ui.model.playing.words import titled
from ui.model.screen import Action, DialoguePopup, GiveAnswer, ShowNext

SpokenLine = tuple[Literal["robot", "you"], str]
"""A sentence, and who says it."""


def destination_popup(hunt: HuntMemory, item: DestinationItem) -> DialoguePopup | None:
    """The talk about where a robot shall go; before it says anything, that it is asked."""
    dialogue = hunt.destination_dialogue(item.robot)
    asked = hunt.pending.destination_request(item.robot)
    if asked is not None:
        about = f" about room {asked.room}" if isinstance(asked, Select) else " for its advice"
        never_mind = Action(ShowNext(), "Never mind", key_of(ShowNext()), hint="Do not ask it.")
        said = _request(hunt, item.robot)
        return DialoguePopup(item.robot, f"Asking {robot_name(item.robot)}{about} …", said, (), never_mind)
    return None if dialogue is None else dialogue_popup(hunt, dialogue)


def dialogue_popup(hunt: HuntMemory, dialogue: DialogueView) -> DialoguePopup:
    """A dialogue that waits for the participant, or for the robot once they have answered."""
    answered = hunt.pending.answer(dialogue.dialogue, dialogue.turn)
    said: list[SpokenLine] = [(speaker_of(index), sentence) for index, sentence in enumerate(dialogue.said)]
    if dialogue.matter == "select-room":
        said = [*_request(hunt, dialogue.robot), *said]
    if answered is not None and answered < len(dialogue.choices):
        said.append(("you", dialogue.choices[answered]))
    choices = tuple(
        Action(GiveAnswer(number), text, key, enabled=answered is None, pending=number == answered)
        for number, (text, key) in enumerate(zip(dialogue.choices, choice_keys(dialogue.choices), strict=True))
    )
    later = Action(ShowNext(), "Later", key_of(ShowNext()), hint="The robot waits for your answer.")
    mind = energy_warning(hunt.view, dialogue.robot, dialogue.room) if dialogue.matter == "select-room" else ""
    return DialoguePopup(dialogue.robot, dialogue_title(hunt, dialogue), tuple(said), choices, later, mind)


def dialogue_title(hunt: HuntMemory, dialogue: DialogueView) -> str:
    """What a dialogue is about."""
    name = titled(dialogue.robot)
    match dialogue.matter:
        case "select-room":
            return f"{name}: go to room {dialogue.room}?"
        case "take-picture":
            return f"{name}: take a picture in room {dialogue.room}?"
        case "take-treasure":
            named = hunt.submitted_names.get(dialogue.room)
            return f"{name}: name it {named}?" if named else f"{name}: name what is in room {dialogue.room}?"


def _request(hunt: HuntMemory, robot: int) -> tuple[SpokenLine, ...]:
    """What the participant said to open the talk; nothing if they did so in another window."""
    said = hunt.opening_sentences.get(robot)
    return () if said is None else (("you", said),)
