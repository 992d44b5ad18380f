"""Any two sides in any dialogues: the engine and a judge who knows only the paper agree after every step."""

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.stateful import run_state_machine_as_test

from tests.thbridge.dialogue.games.dialogue_machine import Talking, talk

QUICK = settings(max_examples=20, stateful_step_count=25, deadline=None, suppress_health_check=list(HealthCheck))
TestTalking = Talking.TestCase
TestTalking.settings = QUICK


@pytest.mark.parametrize("hundred", [0, *(pytest.param(each, marks=pytest.mark.slow) for each in (1, 2))])
def test_talk_of_all_kinds(hundred: int) -> None:
    for seed in range(100 * hundred, 100 * hundred + 100):
        talk(seed)


@pytest.mark.slow
@pytest.mark.parametrize("thousand", range(10))
def test_much_talk(thousand: int) -> None:
    for seed in range(1000 * thousand, 1000 * thousand + 1000):
        talk(seed)


@pytest.mark.slow
def test_long_talk() -> None:
    run_state_machine_as_test(Talking, settings=settings(QUICK, max_examples=1500, stateful_step_count=50))
