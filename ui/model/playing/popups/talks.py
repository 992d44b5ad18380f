"""The pop-up in which a robot talks with the participant."""

from typing import Literal

from thbridge.hunt.rules import robot_name
from thbridge.roles.view import DialogueView, Select
from ui.model.keys import choice_keys, key_of
from ui.model.playing.history import speaker_of
from ui.model.playing.possible import warning
from ui.model.playing.queue import Talk
from ui.model.playing.state import Hunt
from ui.model.playing.words import titled
from ui.model.screen import Action, DialoguePop, GiveAnswer, ShowNext

Said = tuple[Literal["robot", "you"], str]
"""A sentence, and who says it."""


def going(hunt: Hunt, item: Talk) -> DialoguePop | None:
    """The talk about where a robot shall go; before it says anything, that it is asked."""
    dialogue = hunt.talk(item.robot)
    asked = hunt.asked.going(item.robot)
    if asked is not None:
        about = f" about room {asked.room}" if isinstance(asked, Select) else " for its advice"
        never_mind = Action(ShowNext(), "Never mind", key_of(ShowNext()), hint="Do not ask it.")
        said = _request(hunt, item.robot)
        return DialoguePop(item.robot, f"Asking {robot_name(item.robot)}{about} …", said, (), never_mind)
    return None if dialogue is None else talking(hunt, dialogue)


def talking(hunt: Hunt, dialogue: DialogueView) -> DialoguePop:
    """A dialogue that waits for the participant, or for the robot once they have answered."""
    answered = hunt.asked.answer(dialogue.dialogue, dialogue.turn)
    said: list[Said] = [(speaker_of(index), sentence) for index, sentence in enumerate(dialogue.said)]
    if dialogue.matter == "select-room":
        said = [*_request(hunt, dialogue.robot), *said]
    if answered is not None and answered < len(dialogue.choices):
        said.append(("you", dialogue.choices[answered]))
    choices = tuple(
        Action(GiveAnswer(number), text, key, enabled=answered is None, busy=number == answered)
        for number, (text, key) in enumerate(zip(dialogue.choices, choice_keys(dialogue.choices), strict=True))
    )
    later = Action(ShowNext(), "Later", key_of(ShowNext()), hint="The robot waits for your answer.")
    mind = warning(hunt.view, dialogue.robot, dialogue.room) if dialogue.matter == "select-room" else ""
    return DialoguePop(dialogue.robot, title(hunt, dialogue), tuple(said), choices, later, mind)


def title(hunt: Hunt, dialogue: DialogueView) -> str:
    """What a dialogue is about."""
    name = titled(dialogue.robot)
    match dialogue.matter:
        case "select-room":
            return f"{name}: go to room {dialogue.room}?"
        case "take-picture":
            return f"{name}: take a picture in room {dialogue.room}?"
        case "take-treasure":
            named = hunt.named.get(dialogue.room)
            return f"{name}: name it {named}?" if named else f"{name}: name what is in room {dialogue.room}?"


def _request(hunt: Hunt, robot: int) -> tuple[Said, ...]:
    """What the participant said to open the talk; nothing if they did so in another window."""
    said = hunt.requests.get(robot)
    return () if said is None else (("you", said),)
