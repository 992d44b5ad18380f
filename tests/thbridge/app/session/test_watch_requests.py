"""What may be asked at the watch door, and what may not."""

import dataclasses
import json
import math
from pathlib import Path
from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.observations import Twist
from sim.inputs import (
    ClearCostmaps,
    DriveManually,
    GlobalLocalization,
    KidnapRobot,
    KillRobot,
    PutThing,
    RemoveThing,
    ReviveRobot,
    SendGoal,
    SetCharge,
    SetPoseEstimate,
    SetSoftwareParameters,
    SetWorldParameters,
)
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.navigator.goals import Goal
from sim.team import Team
from tests.support.hunts.watch_requests import CRATE, GRANTED, HERE, SURE
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.setting import read_setting
from thbridge.app.session.input_records import decode_request
from thbridge.app.session.watch_requests import MOST_PENDING, WatchRequest, WatchRequestHandler, request_line
from thbridge.roles.shared.robot_requests import (
    REQUESTS,
    PaceRequest,
    Pause,
    Request,
    Resume,
    SetParameters,
    SetRate,
    Step,
    WizardAdvice,
    WizardMode,
    WizardMove,
    WizardRequest,
)
from thbridge.roles.simr.controls import RobotControls
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.records import InitialPose, SimpleGoal, VelocityCommand
from thbridge.study.study_file import Study
from thbridge.timing.pacer import Pacer


@pytest.fixture(scope="module")
def team() -> Team:
    return build_team(read_setting(dataclasses.replace(Study(), robots=2), Path()))


class Visited:
    """A desk, and what it has passed on."""

    def __init__(self, team: Team, has_game: bool = True) -> None:
        self.asked: list[tuple[str, Request]] = []
        self.pacer = Pacer(1.0)
        self.by_key: list[tuple[str, str]] = []
        self.desk = WatchRequestHandler(
            lambda sender, request: self.asked.append((sender, request)),
            team,
            self.pacer,
            lambda key, request: self.by_key.append((key, request)),
            has_game=has_game,
        )

    def wish(self, request: Request | PaceRequest, sender: str = "window", key: str = "") -> str | None:
        return self.desk.ask("watcher 1", json.loads(request_line(sender, request)), key)


@pytest.fixture
def visited(team: Team) -> Visited:
    return Visited(team)


def same(one: object, other: object) -> bool:
    return repr(one) == repr(other)


def test_whoever_shows_a_key_asks_by_it_and_in_no_other_name(visited: Visited) -> None:
    assert visited.wish(ClearCostmaps(1), "Father Christmas", "maria") is None
    assert visited.wish(ClearCostmaps(7), key="maria") is not None
    assert visited.wish(SetRate(2.0), key="maria") is None
    assert visited.asked == [("watcher 1", ClearCostmaps(1))]
    assert visited.by_key == [("maria", 'ClearCostmaps {"robot": 1}'), ("maria", 'SetRate {"rate": 2.0}')]


def test_every_kind_that_is_granted_is_tried_here() -> None:
    assert {type(request) for request in GRANTED} == set(get_args(WatchRequest))


@pytest.mark.parametrize("request_", GRANTED, ids=lambda request: type(request).__name__)
def test_what_is_granted_is_asked_in_the_watchers_name(visited: Visited, request_: WatchRequest) -> None:
    assert visited.wish(request_) is None
    ((sender, asked),) = visited.asked
    assert sender == "window"
    match request_:
        case SendGoal(robot, goal):
            assert asked == SendGoal(robot, Goal(0, goal.base_in_map, GoalOwner.RESEARCHER))
        case SimpleGoal():
            assert asked == dataclasses.replace(request_, number=0, owner=GoalOwner.RESEARCHER)
        case _:
            assert same(asked, request_)


def test_who_gives_no_name_goes_by_the_doors(visited: Visited) -> None:
    assert visited.desk.ask("watcher 4", {"request": "Die", "fields": {"robot": 1}}) is None
    assert visited.asked == [("watcher 4", KillRobot(1))]


FAR = Pose2(1e7, 0.0, 0.0)
REFUSED: list[tuple[Request, str]] = [
    (KillRobot(2), "robot"),
    (ReviveRobot(-1), "robot"),
    (KidnapRobot(0, FAR), "any map"),
    (SimpleGoal(0, None, 1), "no pose"),
    (SendGoal(0, Goal(1, FAR)), "any map"),
    (SendGoal(0, Goal(1, Pose2(0.0, math.nan, 0.0))), "any map"),
    (VelocityCommand(0, Twist(1e300, 0.0)), "too high"),
    (VelocityCommand(0, Twist(0.0, math.nan)), "too high"),
    (SetPoseEstimate(0, HERE, -SURE), "covariance"),
    (InitialPose(0, HERE, np.eye(2)), "covariance"),
    (SetParameters(0, (("amcl.no_such", 1),)), "amcl.no_such"),
    (SetParameters(0, (("amcl.max_particles", -1),)), "max_particles"),
    (SetParameters(0, (("world.laser.range_noise", -1),)), "world.laser.range_noise is at least 0"),
    (SetParameters(0, (("world.laser.beams", 90),)), "world.laser.beams cannot change"),
    (SetParameters(0, (("world.odometry.linear_scale", 1.1), ("world", 1))), "world"),
    (PutThing(dataclasses.replace(CRATE, name="")), "name"),
    (PutThing(dataclasses.replace(CRATE, speed=math.pi * 1e9)), "the speed of a thing must be 0 to 10 m/s"),
    (PutThing(dataclasses.replace(CRATE, base_in_map=FAR)), "any map"),
    (PutThing(dataclasses.replace(CRATE, footprint=((0.0, 0.0), (1.0, 0.0), (2.0, 0.0)))), "enclose"),
    (PutThing(dataclasses.replace(CRATE, footprint=((0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 2.0)))), "enclose"),
    (RemoveThing("x" * 1000), "name"),
    (SetSoftwareParameters(0, RobotParameters()), "watchers cannot send the request Configure"),
    (SetWorldParameters(0, WorldParameters()), "watchers cannot send the request Disturb"),
    (SetCharge(0, 1e9), "watchers cannot send the request SetCharge"),
    (WizardMode(2, on=True), "robot"),
    (WizardAdvice(-1, 3), "robot"),
    (WizardMove(1, 0, 0, "one\ntwo"), "one line"),
    (WizardMove(1, 0, 0, "x" * 1000), "one line"),
    (DriveManually(0, Twist(1.0, 0.0), 10**9), "watchers cannot send the request Drive"),
]


@pytest.mark.parametrize(("request_", "why"), REFUSED, ids=lambda item: type(item).__name__)
def test_what_a_session_could_not_bear_is_refused_with_the_reason(
    visited: Visited, request_: Request, why: str
) -> None:
    reason = visited.wish(request_)
    assert reason is not None
    assert why in reason
    assert visited.asked == []


@pytest.mark.parametrize(
    "wish",
    [
        {},
        {"request": 3},
        {"request": "Dance", "fields": {}},
        {"request": "Die"},
        {"request": "Die", "fields": {"robot": "one"}},
        {"request": "Die", "fields": {"robot": 10**400}},
        {"request": "Die", "fields": [0]},
        {"request": "Die", "fields": {"robot": 0}, "sender": 7},
        {"request": "Die", "fields": {"robot": 0}, "sender": "x" * 1000},
        {"request": "Localize", "fields": {"robot": 0, "base_in_map": {"x": 0, "y": 0, "theta": 0}, "covariance": {}}},
        {"request": "Step", "fields": {"ticks": 0}},
        {"request": "SetRate", "fields": {"rate": -1.0}},
        {"request": "SetRate", "fields": {"rate": 1e-9}},
        {"request": "SetParameters", "fields": {"robot": 0, "values": [["robot.footprint", "[" * 50_000]]}},
    ],
)
def test_what_cannot_be_understood_is_refused_in_words(visited: Visited, wish: dict[str, object]) -> None:
    assert visited.desk.ask("watcher 1", wish)
    assert visited.asked == []


def test_the_pace_is_turned_at_once_and_is_no_input(visited: Visited) -> None:
    assert visited.wish(Pause()) is None
    assert visited.desk.pace().paused
    assert visited.wish(Step(3)) is None
    assert visited.desk.pace().paused
    assert visited.wish(SetRate(2.5)) is None
    assert visited.desk.pace().rate == 2.5
    assert visited.wish(Resume()) is None
    assert not visited.desk.pace().paused
    assert visited.asked == []


def test_a_pause_ends_when_nobody_watches_any_more(visited: Visited) -> None:
    visited.wish(Pause())
    visited.desk.unwatched()
    assert not visited.pacer.paused


def test_robots_are_released_when_nobody_watches_any_more(visited: Visited) -> None:
    for request in (WizardMode(1, on=True), WizardMode(0, on=True), WizardMode(1, on=False)):
        visited.wish(request)
    del visited.asked[:]
    visited.desk.unwatched()
    assert [request for _, request in visited.asked] == [WizardMode(0, on=False), WizardMode(1, on=False)]
    visited.desk.unwatched()
    assert len(visited.asked) == 2


def test_where_the_game_is_another_programs_nobody_can_be_spoken_for(team: Team) -> None:
    visited = Visited(team, has_game=False)
    assert "another program" in (visited.wish(WizardMode(0, on=True)) or "")
    assert visited.wish(KillRobot(0)) is None


def test_so_much_may_be_asked_between_two_ticks_and_no_more(visited: Visited) -> None:
    answers = [visited.wish(GlobalLocalization(0)) for _ in range(MOST_PENDING + 3)]
    assert [answer is None for answer in answers] == [True] * MOST_PENDING + [False] * 3
    visited.desk.take(1, [])
    assert visited.wish(GlobalLocalization(0)) is None


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=8,
)
NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(10**6), 10**6)
POSES = st.fixed_dictionaries({"x": NUMBERS, "y": NUMBERS, "theta": NUMBERS})
POINTS = st.lists(st.lists(NUMBERS, min_size=2, max_size=2), max_size=5)
THINGS = st.fixed_dictionaries({"name": st.text(max_size=3), "footprint": POINTS, "base_in_map": POSES, "path": POINTS})
FIELDS = st.fixed_dictionaries(
    {},
    optional={
        "robot": st.integers(-1, 3) | JSON,
        "base_in_map": POSES | JSON,
        "covariance": st.lists(st.lists(NUMBERS, min_size=3, max_size=3), min_size=3, max_size=3) | JSON,
        "thing": THINGS | JSON,
        "name": JSON,
        "goal": st.fixed_dictionaries({"id": st.integers(), "base_in_map": POSES}),
        "number": st.just(0),
        "values": st.lists(st.tuples(st.sampled_from(["amcl.kld_err", "x", "amcl", ""]), JSON), max_size=2),
        "twist": st.fixed_dictionaries({"linear": NUMBERS, "angular": NUMBERS}),
    },
)
KINDS = st.sampled_from(list(REQUESTS))


@given(st.lists(st.tuples(KINDS, FIELDS), max_size=5))
def test_whatever_is_wished_the_answer_is_words_or_a_team_can_bear_it(
    team: Team, wishes: list[tuple[str, dict[str, object]]]
) -> None:
    visited = Visited(team)
    for kind, fields in wishes:
        answer = visited.desk.ask("fuzz", {"request": kind, "fields": fields})
        assert answer is None or answer
    controls = RobotControls(team)
    for _, request in visited.asked:
        assert same(decode_request(json.loads(request_line("", request))).request, request)
        if not isinstance(request, WizardRequest):
            controls.ask(request)
    for tick in range(2):
        controls.follow(team.step(controls.take_inputs(tick)))
