"""SimR with real robots, alone: what it does on the lines of 2016, and what it tells whom."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

from sim.common.observations import TICKS_PER_SECOND
from sim.snapshot import TeamSnapshot
from sim.team import Team
from tests.thbridge.roles.simr.driven_simr import DrivenSimR, orders
from thbridge.app.compose.robots import build_simr, build_team
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.hunt.events import Condition
from thbridge.roles.shared.notices import MoveOrder, MoveResult, PoseTelemetry, RobotsReady, Subscribe, TeamStatus
from thbridge.roles.shared.robot_requests import SetParameters
from thbridge.roles.simr.pose_telemetry import POSE_PERIOD, SUBSCRIPTION_TICKS
from thbridge.roles.simr.simr import KEEPER_TIMEOUT, RESPONSE_TIMEOUT
from thbridge.study.study_file import Study
from thbridge.study.things import Mishap, MishapEntry, Shape, ThingEntry
from thbridge.text_protocol.wire import canonical, legacy
from thbridge.text_protocol.wire.notice_format import encode_notice


@pytest.fixture(scope="module")
def setting() -> StudySetting:
    return read_setting(replace(Study(), robots=2), Path())


@pytest.fixture
def driver(setting):
    return DrivenSimR(build_simr(setting))


def test_it_introduces_itself_when_connected(driver):
    driver.simr.connected()
    driver.run(1)
    (ready,) = driver.levels(RobotsReady)
    assert (ready.map, ready.robots, len(ready.costs)) == ("arena8", 2, 9)


def test_without_a_keeper_it_obeys_as_in_2016(driver):
    driver.run(KEEPER_TIMEOUT, legacy.GotoRoom(0, 1).message())
    assert driver.simr.snapshot.robots[0].navigation.goal is None
    driver.until('%%error SimR TabUI "0;1" ')


def test_with_a_keeper_only_its_orders_count(driver):
    driver.run(1, orders(1, None, None))
    driver.run(KEEPER_TIMEOUT + 5, legacy.GotoRoom(0, 1).message())
    assert driver.simr.snapshot.robots[0].navigation.goal is None
    driver.run(2, orders(1, MoveOrder(1, 2), None))
    assert driver.simr.snapshot.robots[0].navigation.goal is not None
    assert driver.simr.snapshot.robots[1].observations.battery.charge == 80.0
    driver.until('%%error SimR TabUI "0;1" ')
    result = driver.levels(TeamStatus)[-1].results[0]
    assert (result.move, result.arrived) == (1, True)


def test_an_order_heard_twice_is_obeyed_once(driver):
    driver.run(2, orders(1, MoveOrder(1, 2), None))
    first = driver.simr.snapshot.robots[0].navigation.goal
    driver.run(2, orders(1, MoveOrder(1, 2), None))
    assert driver.simr.snapshot.robots[0].navigation.goal is first


def test_a_withdrawn_order_stops_the_robot_and_is_reported(driver):
    driver.run(100, orders(1, MoveOrder(1, 8), None))
    driver.run(5, orders(1, None, None))
    assert driver.simr.snapshot.robots[0].navigation.goal is None
    result = driver.levels(TeamStatus)[-1].results[0]
    assert (result.move, result.arrived) == (1, False)
    assert 0.0 <= result.share < 1.0


def test_a_robot_called_back_under_way_goes_where_it_is_sent_next(driver):
    driver.run(150, orders(1, MoveOrder(1, 8), None))
    driver.run(5, orders(1, None, None))
    assert driver.levels(TeamStatus)[-1].results[0].sentence == "It was called back."
    driver.run(2, orders(1, MoveOrder(2, 2), None))
    driver.until('%%error SimR TabUI "0;1" ')
    driver.run(1)
    assert driver.levels(TeamStatus)[-1].results[0] == MoveResult(2, True, "", 1.0)


def test_back_in_a_game_robots_are_where_they_were(driver):
    driver.run(2, orders(3, None, None, poses=((0.5, 1.0, 0.3), (2.0, 1.0, 0.0))))
    assert driver.simr.snapshot.world.poses[0].tolist() == [0.5, 1.0, 0.3]
    believed = driver.simr.snapshot.robots[0].estimate.base_in_map
    assert math.hypot(believed.x - 0.5, believed.y - 1.0) < 0.2


def test_back_in_a_game_without_poses_robots_stand_in_their_rooms(driver, setting):
    driver.run(2, orders(3, None, None, at=(4, 0)))
    goal = setting.map.rooms[3].goal
    assert driver.simr.snapshot.world.poses[0].tolist() == [goal.x, goal.y, goal.theta]


def test_where_is_answered_with_what_the_robot_believes(driver):
    driver.run(1)
    (answer,) = [m for m in driver.run(1, canonical.encode(canonical.PoseQuery(1), "Me", "SimR")) if m.receiver == "Me"]
    pose = canonical.decode(answer)
    assert isinstance(pose, canonical.PoseReport)
    believed = driver.simr.snapshot.robots[1].estimate.base_in_map
    assert (pose.robot, pose.x, pose.y) == (1, pytest.approx(believed.x, abs=0.05), pytest.approx(believed.y, abs=0.05))


def test_a_robot_is_driven_by_hand_for_half_a_second(driver):
    driver.run(1)
    driver.run(40, canonical.encode(canonical.MoveByHand(0, canonical.MoveDirection.FORWARD, 5), "Me", "SimR"))
    # 0.5 m/s for 25 ticks of 20 ms.
    assert driver.simr.snapshot.world.poses[0][0] == pytest.approx(0.25, abs=0.02)


def test_a_robot_goes_to_a_point_in_metres(driver):
    driver.run(1)
    driver.run(400, canonical.encode(canonical.GotoPoint(0, 0.0, 1.5), "Me", "SimR"))
    x, y, _ = driver.simr.snapshot.world.poses[0]
    assert math.hypot(x, y - 1.5) < 0.25


def test_whereabouts_go_to_those_who_asked_for_as_long_as_they_ask(driver):
    driver.run(20, encode_notice("Window", legacy.SIMR, Subscribe()))
    assert len(driver.levels(PoseTelemetry)) == 20 // POSE_PERIOD
    driver.run(SUBSCRIPTION_TICKS)
    told = len(driver.levels(PoseTelemetry))
    driver.run(50)
    assert len(driver.levels(PoseTelemetry)) == told


def with_mishaps(setting: StudySetting, *mishaps: tuple[Mishap, float]) -> DrivenSimR:
    entries = tuple(MishapEntry(robot=1, what=what, time=time) for what, time in mishaps)
    return DrivenSimR(build_simr(replace(setting, study=replace(setting.study, mishaps=entries))))


def test_the_move_of_a_robot_that_died_fails_with_its_reason(setting):
    driver = with_mishaps(setting, (Mishap.DIES, 1.0))
    driver.run(60, orders(1, MoveOrder(1, 2), None))
    assert driver.levels(TeamStatus)[-1].results[0] is None
    driver.run(RESPONSE_TIMEOUT)
    result = driver.levels(TeamStatus)[-1].results[0]
    assert (result.arrived, result.sentence) == (False, "Robot 1 no longer answers.")
    assert driver.levels(TeamStatus)[-1].conditions == (Condition.SILENT, Condition.WELL)


def test_a_robot_that_revives_is_told_of_at_once(setting):
    driver = with_mishaps(setting, (Mishap.DIES, 0.1), (Mishap.REVIVES, 5.5))
    driver.run(270)
    assert driver.levels(TeamStatus)[-1].conditions[0] is Condition.SILENT
    driver.run(8)
    assert driver.levels(TeamStatus)[-1].conditions[0] is Condition.WELL


@pytest.mark.parametrize("ordered", [20, 80])
def test_a_robot_that_was_dead_for_a_moment_goes_where_it_was_sent(setting, ordered):
    """Whether it has forgotten its order by that or has never heard it."""
    driver = with_mishaps(setting, (Mishap.DIES, 1.0), (Mishap.REVIVES, 3.0))
    driver.run(ordered, orders(1, None, None))
    driver.run(200 - ordered, orders(1, MoveOrder(1, 2), None))
    assert driver.simr.snapshot.robots[0].navigation.goal is not None
    driver.run(5, orders(1, None, None))
    assert driver.levels(TeamStatus)[-1].results[0].sentence == "It was called back."


def test_a_robot_called_back_while_it_was_dead_for_a_moment_stays(setting):
    driver = with_mishaps(setting, (Mishap.DIES, 1.0), (Mishap.REVIVES, 3.0))
    driver.run(80, orders(1, MoveOrder(1, 2), None))
    driver.run(120, orders(1, None, None))
    assert driver.simr.snapshot.robots[0].navigation.goal is None
    assert driver.levels(TeamStatus)[-1].results[0].sentence == "It was called back."


def test_a_room_behind_a_closed_door_is_told_of_in_words(setting):
    door = ThingEntry(name="door", shape=Shape.DOOR, at=(7.0, -4.0, math.pi / 2), size=(2.0, 0.1))
    driver = DrivenSimR(build_simr(replace(setting, study=replace(setting.study, things=(door,)))))
    driver.run(100 * TICKS_PER_SECOND, orders(1, MoveOrder(1, 8), None))
    result = driver.levels(TeamStatus)[-1].results[0]
    assert result.sentence == "Something that is not on the map blocks the path of robot 1."


class Real:
    """Robots about which nobody knows the truth."""

    parameters = ()

    def __init__(self, team: Team) -> None:
        self._team = team
        self.size = team.size

    def step(self, inputs=()) -> TeamSnapshot:
        return replace(self._team.step(inputs), world=None)


def test_of_real_robots_it_tells_what_they_believe_and_sets_no_parameters(setting):
    driver = DrivenSimR(build_simr(setting, Real(build_team(setting))))
    driver.simr.ask(SetParameters(0, (("amcl.kld_err", 0.2),)))
    driver.run(2, orders(1, MoveOrder(1, 2), None))
    driver.until('%%error SimR TabUI "0;1" ')
    believed = driver.simr.snapshot.robots[0].estimate.base_in_map
    driver.run(1)
    assert driver.levels(TeamStatus)[-1].poses[0] == pytest.approx((believed.x, believed.y, believed.theta), abs=0.05)
