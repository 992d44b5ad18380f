"""What those hear who follow the robots on a map."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.inputs import SendGoal
from sim.robot.navigator.goals import Goal
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.setting import read_setting
from thbridge.hunt.events import Condition
from thbridge.line_splitter import LINE_LIMIT
from thbridge.roles.shared.notices import PlannedPaths, PoseTelemetry
from thbridge.roles.simr.pose_telemetry import PATH_PERIOD, TelemetryOptions, TelemetryPublisher, ellipse_of
from thbridge.study.study_file import Study
from thbridge.text_protocol.wire.notice_format import decode_notice, parse_notice

TICKS = range(0, 2 * PATH_PERIOD)


@pytest.fixture(scope="module")
def team():
    """Two robots some way on their ways, and three ticks of theirs."""
    setting = read_setting(replace(Study(), robots=2), Path())
    team = build_team(setting)
    goals = [SendGoal(robot, Goal(1, setting.map.rooms[room].goal)) for robot, room in ((0, 4), (1, 7))]
    team.step(goals)
    for _ in range(150):
        team.step()
    return [team.step() for _ in range(3)]


def told(snapshot, options=None, ticks=TICKS, conditions=None, publisher=None):
    publisher = publisher or TelemetryPublisher("SimR", options or TelemetryOptions())
    publisher.subscribe("Window", 0)
    conditions = conditions or [Condition.WELL] * len(snapshot.robots)
    return [m for tick in ticks for m in publisher.messages(tick, snapshot, conditions, {0: 0.25})]


def levels(messages, kind):
    return [level for message in messages if (level := decode_notice(parse_notice(message), kind)) is not None]


def test_robots_under_way_are_told_with_what_they_do(team):
    first = levels(told(team[0]), PoseTelemetry)[0]
    robot = team[0].robots[0]
    assert first.tick == team[0].tick
    assert first.poses[0] == pytest.approx(robot.estimate.base_in_map.array(), abs=6e-4)
    motion = first.motions[0]
    assert (motion.doing, motion.waits_for, motion.progress) == ("driving", None, 0.25)
    assert motion.remaining == pytest.approx(robot.navigation.remaining, abs=6e-4)


def navigating(snapshot, **changes):
    robots = tuple(replace(each, navigation=replace(each.navigation, **changes)) for each in snapshot.robots)
    return replace(snapshot, robots=robots)


@pytest.mark.parametrize(
    ("changes", "condition", "doing"),
    [
        ({"state": "idle"}, Condition.WELL, "resting"),
        ({"state": "planning"}, Condition.WELL, "planning"),
        ({"state": "planning", "waits_for": 1}, Condition.WELL, "waiting"),
        ({"state": "controlling", "waits_for": 1}, Condition.LOST, "waiting"),
        ({"state": "clearing"}, Condition.WELL, "clearing"),
        ({"state": "controlling", "waits_for": 1}, Condition.SILENT, "silent"),
    ],
)
def test_what_a_robot_does_has_a_word(team, changes, condition, doing):
    motion = levels(told(navigating(team[0], **changes), conditions=[condition] * 2), PoseTelemetry)[0].motions[0]
    assert motion.doing == doing
    assert motion.waits_for == (1 if doing == "waiting" else None)


@pytest.mark.parametrize(("condition", "told_of"), [(Condition.WELL, 0), (Condition.SILENT, None)])
def test_for_whom_a_robot_makes_way_is_told_while_it_answers(team, condition, told_of):
    snapshot = navigating(team[0], makes_way_for=0)
    motions = levels(told(snapshot, conditions=[condition] * 2), PoseTelemetry)[0].motions
    assert [motion.makes_way_for for motion in motions] == [told_of] * 2


@given(st.booleans(), st.booleans(), st.booleans())
def test_what_the_study_does_not_show_is_not_told(team, way, uncertainty, truth):
    messages = told(team[0], TelemetryOptions(way, uncertainty, truth))
    (whereabouts, *_), ways = levels(messages, PoseTelemetry), levels(messages, PlannedPaths)
    assert bool(ways) == way
    assert (whereabouts.ellipses is not None) == uncertainty
    assert (whereabouts.truth is not None) == truth
    if truth:
        assert np.allclose(whereabouts.truth, team[0].truth.poses, atol=6e-4)
    if uncertainty:
        assert whereabouts.ellipses[1] == ellipse_of(team[0].robots[1].estimate.covariance)


def test_of_real_robots_nobody_tells_the_truth(team):
    assert levels(told(replace(team[0], world=None), TelemetryOptions(truth=True)), PoseTelemetry)[0].truth is None


def test_a_way_leads_from_the_robot_to_its_goal_and_is_off_by_less_than_three_centimetres(team):
    (ways,) = levels(told(team[0]), PlannedPaths)
    for way, output in zip(ways.ways, team[0].robots, strict=True):
        here, plan = output.estimate.base_in_map, output.navigation.plan[1:, :2]
        assert math.dist(way[0], (here.x, here.y)) < 0.01
        assert math.dist(way[-1], plan[-1]) < 0.01
        assert len(way) < len(plan) / 2
        line = np.array(way)
        assert max(off(point, line) for point in plan) < 0.03


def test_a_way_stays_true_while_it_is_driven(team):
    publisher = TelemetryPublisher("SimR", TelemetryOptions())
    publisher.subscribe("Window", 0)
    whole = team[0].robots[0].navigation.plan
    for passed in range(0, len(whole) - 1, 7):
        here = Pose2(*(whole[passed] + [0.005, -0.005, 0.0]).tolist())
        robots = [
            replace(
                each,
                navigation=replace(each.navigation, plan=whole[passed:]),
                estimate=replace(each.estimate, base_in_map=here),
            )
            for each in team[0].robots
        ]
        snapshot = replace(team[0], robots=tuple(robots))
        (ways,) = levels(publisher.messages(passed * PATH_PERIOD, snapshot, [Condition.WELL] * 2, {}), PlannedPaths)
        line = np.array(ways.ways[0])
        assert math.dist(line[0], (here.x, here.y)) < 0.01
        assert max(off(point, line) for point in whole[passed + 1 :, :2]) < 0.03


def off(point, line):
    starts, along = line[:-1], np.diff(line, axis=0)
    share = np.clip(((point - starts) * along).sum(axis=1) / (along**2).sum(axis=1), 0, 1)
    return np.hypot(*(point - starts - share[:, None] * along).T).min()


def test_a_way_that_is_only_wished_for_is_none(team):
    assert levels(told(navigating(team[0], state="planning")), PlannedPaths)[0].ways == ((), ())


def test_a_robot_that_does_not_answer_has_no_way_ahead(team):
    ways = levels(told(team[0], conditions=[Condition.SILENT, Condition.WELL]), PlannedPaths)[0].ways
    assert (ways[0], bool(ways[1])) == ((), True)


def test_ways_are_told_when_they_change_and_to_those_who_ask_anew(team):
    publisher = TelemetryPublisher("SimR", TelemetryOptions())
    assert len(levels(told(team[0], publisher=publisher), PlannedPaths)) == 1
    again = [m for tick in range(10, 20) for m in publisher.messages(tick, team[0], [Condition.WELL] * 2, {})]
    assert levels(again, PlannedPaths) == []
    moved = navigating(team[0], plan=team[0].robots[0].navigation.plan[10:])
    assert (
        len(
            levels(
                [m for t in range(20, 30) for m in publisher.messages(t, moved, [Condition.WELL] * 2, {})], PlannedPaths
            )
        )
        == 1
    )
    assert len(levels(told(moved, publisher=publisher, ticks=range(30, 40)), PlannedPaths)) == 1


def test_sixty_four_robots_fit_into_lines(team):
    robots = (team[0].robots[0],) * 64
    world = replace(team[0].truth, poses=np.tile(np.array([-123.456, -123.456, -3.141]), (64, 1)))
    wiggle = np.random.default_rng(1).uniform(-123, -100, (100, 3))
    snapshot = navigating(replace(team[0], robots=robots, world=world), plan=wiggle, waits_for=63)
    messages = told(snapshot, TelemetryOptions(True, True, True), range(1))
    assert len(messages) == 2
    assert max(len(message.line()) for message in messages) < LINE_LIMIT / 2


@given(st.floats(0.01, 3.0), st.floats(0.01, 3.0), st.floats(-3.1, 3.1))
def test_an_ellipse_holds_what_it_says(a, b, angle):
    c, s = math.cos(angle), math.sin(angle)
    turn = np.array([[c, -s], [s, c]])
    covariance = np.eye(3)
    covariance[:2, :2] = turn @ np.diag([a * a, b * b]) @ turn.T
    ellipse = ellipse_of(covariance)
    scale = math.sqrt(5.991)
    assert (ellipse.major, ellipse.minor) == pytest.approx((scale * max(a, b), scale * min(a, b)), abs=2e-3)
    if abs(a - b) > 0.1:
        axis = angle if a > b else angle + math.pi / 2
        assert math.sin(ellipse.angle - axis) == pytest.approx(0.0, abs=0.01)


def test_an_ellipse_of_chance_holds_95_percent():
    covariance = np.array([[0.5, 0.3, 0.0], [0.3, 0.4, 0.0], [0.0, 0.0, 1.0]])
    points = np.random.default_rng(3).multivariate_normal([0, 0], covariance[:2, :2], 20_000)
    ellipse = ellipse_of(covariance)
    x, y = Pose2(0, 0, ellipse.angle).inverse().transform(points).T
    assert ((x / ellipse.major) ** 2 + (y / ellipse.minor) ** 2 < 1).mean() == pytest.approx(0.95, abs=0.01)
