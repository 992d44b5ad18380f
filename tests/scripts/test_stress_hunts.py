"""Hunts in all conditions of dialogues: drawn by their seeds alone, and played to their ends."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from scripts.stress_hunts import drawn_hunt, drawn_study, play, play_conditions
from thbridge.app.compose.setting import read_setting
from thbridge.dialogue.conditions import DialogueCondition
from thbridge.dialogue.games.strategies import Attitude
from thbridge.study.study_file import DialogueSection, Study
from thbridge.study.things import Mishap

SCRIPT, COLLABORATOR = DialogueCondition.SCRIPT, DialogueCondition.COLLABORATOR


def studies(condition: DialogueCondition, count: int = 60) -> list[Study]:
    return [drawn_study(drawn_hunt(seed, condition), condition) for seed in range(count)]


def test_all_but_the_condition_is_drawn_by_the_seed():
    def scripted(study: Study) -> Study:
        return replace(study, dialogue=replace(study.dialogue, condition=SCRIPT))

    drawn = studies(COLLABORATOR)
    assert list(map(scripted, drawn)) == studies(SCRIPT)
    assert len({(study.map, study.robots) for study in drawn}) == 12
    assert {study.participant.attitude for study in drawn} == set(Attitude)
    assert {mishap.what for study in drawn for mishap in study.mishaps} == {Mishap.DIES, Mishap.REVIVES}
    assert 0 < sum(bool(study.things) for study in drawn) < len(drawn)
    assert max(study.dialogue.manner.misheard for study in drawn) > DialogueSection().manner.misheard


def test_drawn_studies_can_be_played():
    for study in studies(COLLABORATOR, 3):
        assert read_setting(study, Path()).study == study


@pytest.mark.slow
def test_hunts_end_in_every_condition_without_collision(capsys: pytest.CaptureFixture[str]):
    with ThreadPoolExecutor(1) as pool:
        assert play_conditions(pool, tuple(DialogueCondition), range(1, 4))
    assert len(capsys.readouterr().out.splitlines()) == 2 + 5 + 5 + 4 * 2


@pytest.mark.slow
def test_a_hunt_is_played_alike_twice():
    hunt = drawn_hunt(1, COLLABORATOR)
    first, again = play(hunt), play(hunt)
    assert replace(first, cpu=0.0) == replace(again, cpu=0.0)
