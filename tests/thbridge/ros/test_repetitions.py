import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.robot.costmap.view import CostmapView
from thbridge.ros.messages import pack
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.names import MAP_FRAME, RobotNames
from thbridge.ros.repetitions import REPEAT_NS, RepetitionFilter
from thbridge.ros.topics import Planners, RobotTopics, RosMessage

ONE, OTHER = (RobotTopics(RobotNames.of(robot), Planners()).local_costmap for robot in range(2))
ODOM = RobotTopics(RobotNames.of(0), Planners()).odom

costmaps = st.tuples(st.integers(0, 1), st.integers(0, 1), st.sampled_from([0, 100, 254]))
"""Column and row of the robot, and what is in the grid's second cell."""


def shown(tick: int, column: int, row: int, cost: int) -> RosMessage:
    costs = np.array([[0, cost], [255, 0]], np.uint8)
    data = pack.costmap(MAP_FRAME, CostmapView(tick, Pose2(0.05 * column, 0.05 * row, 0.0), 0.05, costs))
    return RosMessage(ONE, stamp_ns(tick), data)


@given(st.lists(st.tuples(st.integers(1, 400), costmaps), min_size=1))
def test_at_any_time_the_last_recorded_costmap_is_the_last_one_published(
    said: list[tuple[int, tuple[int, ...]]],
) -> None:
    keep = RepetitionFilter()
    recorded: list[tuple[int, tuple[int, ...]]] = []
    tick = 0
    for after, costmap in said:
        tick += after
        if keep([shown(tick, *costmap)]):
            recorded.append((tick, costmap))
        last_tick, last = recorded[-1]
        assert last == costmap
        assert stamp_ns(tick) - stamp_ns(last_tick) < REPEAT_NS


def test_a_costmap_that_stays_the_same_is_recorded_every_ten_seconds() -> None:
    keep = RepetitionFilter()
    assert [tick for tick in range(0, 1501, 50) if keep([shown(tick, 0, 0, 254)])] == [0, 500, 1000, 1500]


def test_each_robot_has_its_own_and_other_messages_are_always_recorded() -> None:
    keep = RepetitionFilter()
    costmap = shown(0, 0, 0, 254)
    assert keep([costmap])
    assert keep([costmap._replace(topic=OTHER)])
    assert not keep([costmap])
    assert keep([RosMessage(ODOM, 0, b"same")])
    assert keep([RosMessage(ODOM, 0, b"same")])
