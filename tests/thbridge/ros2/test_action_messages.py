"""Messages of actions."""

from typing import cast

from hypothesis import given
from hypothesis import strategies as st

from thbridge.ros2.action_messages import encode_statuses, goal_statuses
from thbridge.ros2.actions import ActionGoalState, ActionGoalStatus, GoalInfo
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.message_fields import GoalStatusArrayFields

ARRAY = "action_msgs/msg/GoalStatusArray"
KILTED = Distribution.of("kilted")
GOALS = st.builds(GoalInfo, st.binary(min_size=16, max_size=16), st.integers(0, 2**31 * 10**9 - 1))


@given(st.lists(st.builds(ActionGoalStatus, GOALS, st.sampled_from(ActionGoalState)), max_size=4))
def test_a_status_list_is_read_as_it_was_written_and_no_byte_is_left(statuses: list[ActionGoalStatus]) -> None:
    data = encode_statuses(statuses)
    read = cast(GoalStatusArrayFields, KILTED.decode(ARRAY, data))
    assert goal_statuses(read) == tuple(statuses)
    assert KILTED.encode(ARRAY, read) == data
