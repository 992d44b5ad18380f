from typing import get_args

import pytest

from sim.robot.global_planning.path import PlanRefusalCode
from sim.robot.navigator.goals import NoPathReason
from thbridge.roles.shared import failure_reasons as reasons

CODES = sorted(
    {*get_args(PlanRefusalCode), *(code for part in get_args(NoPathReason) for code in get_args(part) or (part,))}
)


@pytest.mark.parametrize("code", CODES)
def test_every_reason_of_the_navigator_is_a_sentence_about_the_robot(code):
    sentence = reasons.failure_sentence(1, code)
    assert "robot 2" in sentence.lower()
    assert sentence[0].isupper() and sentence.endswith(".")


def test_no_two_reasons_are_told_alike():
    assert len({reasons.failure_sentence(0, code) for code in CODES}) == len(CODES)
