"""Hunts in each condition of a study, run again from their recordings."""

import dataclasses
from pathlib import Path

import pytest

from tests.support.hunts.recorded_hunts import STUDY, assert_equal_replay, record
from tests.support.slow import slow
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.strategies import Attitude
from thbridge.recording.bag.reading.reader import messages
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.ros import names
from thbridge.study.study_file import DialogueSection, MannerSection, ParticipantSection


@pytest.mark.parametrize(
    "condition",
    [
        DialogueCondition.COLLABORATOR,
        *slow(*(each for each in DialogueCondition if each is not DialogueCondition.COLLABORATOR)),
    ],
)
def test_a_hunt_in_any_condition_is_the_same_again_to_the_last_bit(
    condition: DialogueCondition, tmp_path: Path
) -> None:
    manner = MannerSection(attitude=Attitude.SCEPTICAL, talkative=True, misheard=0.3)
    study = dataclasses.replace(
        STUDY,
        dialogue=DialogueSection(condition=condition, manner=manner),
        participant=ParticipantSection(BotStrategy.SUGGESTION, Attitude.SCEPTICAL),
    )
    bag = tmp_path / "hunt.bag"
    record(bag, study, 3.0)
    said = [message for message in messages(bag) if message.topic == names.UTTERANCES]
    assert len(said) > 3
    assert_equal_replay(bag, 3 * 50)
