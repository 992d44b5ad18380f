"""The practice game of `thbridge play`."""

from dataclasses import replace
from pathlib import Path

import pytest

from thbridge.app.compose.setting import read_setting
from thbridge.dialogue.moves import Scenario
from thbridge.study.built_in import BUILT_IN
from ui.hosting.games import practice_setting


@pytest.mark.parametrize(
    ("name", "language", "answers"),
    [
        ("standard", "en", ("Go", "Not there")),
        ("standard", "de", ("Fahr", "Nicht dorthin")),
        ("original-2016", "en", ("Continue", "Stop")),
        ("original-2016", "de", ("Weiter", "Stopp")),
    ],
)
def test_practice_has_the_answers_of_the_game_that_follows(name: str, language: str, answers: tuple[str, str]) -> None:
    study = BUILT_IN[name]
    study = replace(study, dialogue=replace(study.dialogue, language=language))
    practice = practice_setting(read_setting(study, Path()))
    assert practice.map.name == "practice"
    assert practice.set_words.dialogue.answers_in(Scenario.SPECIFIC_ROOM, practice.texts) == answers
