"""The practice game of `thbridge play`."""

from pathlib import Path

import pytest

from thbridge.app.compose.setting import read_setting
from thbridge.dialogue.moves import Scenario
from thbridge.study.built_in import BUILT_IN
from ui.hosting.games import practice_setting


@pytest.mark.parametrize(
    ("name", "answers"), [("standard", ("Go", "Not there")), ("original-2016", ("Continue", "Stop"))]
)
def test_practice_has_the_answers_of_the_game_that_follows(name: str, answers: tuple[str, str]) -> None:
    practice = practice_setting(read_setting(BUILT_IN[name], Path()))
    assert practice.map.name == "practice"
    assert practice.templates.dialogue.answers_in(Scenario.SPECIFIC_ROOM) == answers
