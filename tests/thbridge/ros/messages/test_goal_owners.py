"""The owner of a goal and its number become one number, and come back."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros.messages.goal_owners import GoalOwner, owned_number, recorded_number


@pytest.mark.parametrize(
    ("owner", "number", "recorded"),
    [
        (GoalOwner.STRANGER, 0, -1),
        (GoalOwner.GAME, 1, 1),
        (GoalOwner.ROS_CLIENT, 0, 1_000_000_000),
        (GoalOwner.WINDOW, 2, 1_500_000_002),
        (GoalOwner.RESEARCHER, 0, 2_000_000_000),
        (GoalOwner.GROUND_STATION, 1, 3_000_000_001),
    ],
)
def test_ranges_of_recordings(owner: GoalOwner, number: int, recorded: int) -> None:
    assert recorded_number(owner, number) == recorded
    assert owned_number(recorded) == (owner, number)


@given(st.integers())
def test_any_number_of_a_watcher_is_somebodys(recorded: int) -> None:
    assert recorded_number(*owned_number(recorded)) == recorded
