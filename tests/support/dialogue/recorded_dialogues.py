"""Records of a dialogue in which a robot argues, for tests."""

from dataclasses import replace

from tests.support.bags.drawn_team import snapshots
from tests.support.bags.remembering_recorder import RememberingRecorder
from tests.support.dialogue.argued_topics import FACTS, formal_engine
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.session import TickRecord
from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.moves import DialogueTopic, DialogueUtterance, Scenario
from thbridge.hunt.rooms import Room
from thbridge.roles.keeper.requests.wizard import WizardState
from thbridge.ros.messages.records import Record
from thbridge.ros.messages.session_records import DialogueMoveRecord, DialogueStateRecord, UtteranceRecord

TOPIC = DialogueTopic(Scenario.SPECIFIC_ROOM, 0, Room(1), 50.0, 500.0, facts=FACTS)
STUBBORN = (
    "challenge(not next(Robot1, Room1))",
    "reject(not next(Robot1, Room1))",
    "assert(next(Robot1, Room1))",
    "assert(wanted(next(Robot1, Room1)))",
    "assert(next(Robot1, Room1))",
)
"""Choices of a participant who wants room 1 until the robot gives in."""
LEAVES = ("challenge(not next(Robot1, Room1))", "Leave()")
PERSISTENT = Manner(persistence=1)


def utterances(
    choices: tuple[str, ...] = STUBBORN, manner: Manner = PERSISTENT, robot: int = 0
) -> tuple[tuple[DialogueUtterance, ...], ...]:
    """Return the utterances at the opening of a dialogue about room 1, and after each choice.

    A choice is named by the beginning of its text.
    """
    talker = formal_engine(manner)
    facts = replace(FACTS, robot=robot)
    step = talker.open(1, replace(TOPIC, robot=robot, facts=facts))
    said = [step.utterances]
    for choice in choices:
        text = choice.replace("Robot1", f"Robot{robot + 1}")
        move = next(each.move for each in talker.choices(step.dialogue) if each.text.startswith(text))
        step = talker.move(step.dialogue, move)
        said.append(step.utterances)
        if step.outcome is not None:
            break
    return tuple(said)


def recorded(*ticks: tuple[DialogueUtterance, ...]) -> list[tuple[Record, ...]]:
    """Return the records of dialogues in each of several ticks."""
    tape, (snapshot,) = RememberingRecorder(), snapshots(2, 1)
    recorder, found = BagRecorder(tape), []
    for said in ticks:
        tape.records = []
        recorder.record(TickRecord(1, (), snapshot, (), (), said, WizardState(), None))
        wanted = UtteranceRecord | DialogueMoveRecord | DialogueStateRecord
        found.append(tuple(record for record in tape.records if isinstance(record, wanted)))
    return found
