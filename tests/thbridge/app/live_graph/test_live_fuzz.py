"""Nonsense at every door of a session on a graph: it goes on, its robots still obey, and a replay is the same."""

import dataclasses
import math
import random
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.robot.navigator.goals import GoalReached
from tests.support.hunts.recorded_hunts import assert_equal_replay
from tests.support.ros.packed_messages import STORE, header, packed, pose, stamped
from tests.thbridge.app.live_graph.visited_session import Visited, cancel, goal
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.rosgraph.wire.xmlrpc import XmlRpcValue
from thbridge.study.study_file import Study

ROBOTS = ("/robot1", "/robot2")
SERVICES = (
    "global_localization",
    "request_nomotion_update",
    "set_pose",
    "move_base/clear_costmaps",
    "move_base/make_plan",
)
SECONDS = 10
CORRIDOR = (2.0, 0.0)
NOTHING_TURNED = bytes(5 * 4)
"""A dynamic_reconfigure/Config: five empty lists."""


def estimate(x: float, y: float, yaw: float, variance: float) -> bytes:
    kind = "geometry_msgs/msg/PoseWithCovariance"
    covariance = np.diag([variance, variance, 0.0, 0.0, 0.0, variance]).ravel()
    believed = STORE.types[kind](pose(x, y, yaw), covariance)
    return packed("geometry_msgs/msg/PoseWithCovarianceStamped", header=header(), pose=believed)


def real(draw: random.Random, topic: str) -> bytes:
    """A message as a client would say it, of some other topic now and then."""
    x, y, name = draw.uniform(-6, 6), draw.uniform(-6, 6), draw.choice(["", "a", "b", "ü" * 40])
    match draw.choice([topic] * 9 + ["move_base/goal"]):
        case "cmd_vel":
            return np.array([draw.uniform(-3, 3), 0, 0, 0, 0, draw.uniform(-9, 9)]).tobytes()
        case "initialpose" | "set_pose":
            return estimate(x, y, draw.uniform(-9, 9), draw.choice([0.0, 1e-300, 0.1, 1e9]))
        case "move_base_simple/goal":
            return stamped(draw.choice(["map", "/map", "odom", ""]), x, y)
        case "move_base/cancel":
            return cancel(name, draw.choice([0, 1, 2**31 - 1]))
        case "move_base/make_plan":
            return stamped(draw.choice(["map", ""]), y, x) + stamped("map", x, y) + np.float32(0.5).tobytes()
        case _:
            return goal(x, y, name, draw.choice([0, 1, 2**31 - 1]))


def spoilt(draw: random.Random, data: bytes) -> bytes:
    found = bytearray(data)
    for _ in range(draw.randint(0, 3)):
        at = draw.randrange(len(found) + 1)
        match draw.randrange(4):
            case 0:
                found[at : at + draw.randint(1, 40)] = b""
            case 1:
                found[at : at + 8] = np.float64(draw.choice([math.nan, math.inf, -1e308, 1e-320])).tobytes()
            case 2:
                found[at : at + 4] = draw.choice([b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", bytes(4)])
            case _:
                found[at : at + 1] = draw.randbytes(draw.randint(1, 4))
    return bytes(found)


VALUES: tuple[XmlRpcValue, ...] = (
    0, -1, 7, 2**31 - 1, -0.0, 0.3, 1e300, math.nan, math.inf, True, False, "", "0.5", "likelihood_field", "\ud800",
    [], [1, [2]], [[0.1, 0.1], [-0.1, 0.1], [0.0, -0.1]], "[[0, 0]]", {}, {"a": {}}, {"min_particles": 9}, b"\0",
)  # fmt: skip


def setting_of(robots: int) -> StudySetting:
    return read_setting(dataclasses.replace(Study(), robots=robots), Path())


def below(tree: XmlRpcValue, name: str) -> Iterator[str]:
    yield name
    if isinstance(tree, dict):
        for key, value in tree.items():
            yield from below(value, f"{name}/{key}")


@pytest.mark.slow
def test_after_a_storm_robots_obey_and_a_replay_is_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    draw, bag = random.Random(20), tmp_path / "storm.bag"
    session = Visited(setting_of(len(ROBOTS)), bag, monkeypatch)
    keys = [key for robot in ROBOTS for key in below(session.doors.declared[robot], robot)]
    whole = {robot: session.doors.declared[robot] for robot in ROBOTS}
    turns = sorted(name for name in session.doors.services if name.endswith("/set_parameters"))
    configured: dict[str, bytes] = {}
    ticks = 0
    with session.writer:
        for name in turns:
            now = session.call(name, NOTHING_TURNED)
            assert isinstance(now, bytes)
            configured[name] = now
        for _ in range(SECONDS * 50):
            for _ in range(draw.choice([0, 0, 0, 1, 3])):
                topic = draw.choice(sorted(session.doors.heard))
                session.say(topic, spoilt(draw, real(draw, topic.split("/", 2)[2])), draw.choice(["/a", "/b", "/a\n"]))
            if draw.random() < 0.1:
                service = draw.choice(SERVICES)
                session.call(f"{draw.choice(ROBOTS)}/{service}", spoilt(draw, real(draw, service)))
            if draw.random() < 0.1:
                session.call(turned := draw.choice(turns), spoilt(draw, configured[turned]))
            if draw.random() < 0.2:
                session.set_parameter(draw.choice(keys), draw.choice(VALUES))
            session.step()
            ticks += 1
        for robot in ROBOTS:
            session.set_parameter(robot, whole[robot])
        for index, robot in enumerate(ROBOTS):
            session.say(f"{robot}/move_base/cancel", cancel())
            x, y, yaw = session.robots().world.poses[index]
            session.call(f"{robot}/set_pose", estimate(x, y, yaw, 0.01))
        for _ in range(50):
            session.step()
        for side, robot in zip((-1.0, 1.0), ROBOTS, strict=True):
            session.say(f"{robot}/move_base/goal", goal(side * CORRIDOR[0], CORRIDOR[1], "home"))
        ticks += len(ROBOTS) + 50
        arrived: set[int] = set()
        while len(arrived) < len(ROBOTS) and ticks < 120 * 50:
            for index, output in enumerate(session.robots().robots):
                if isinstance(output.navigation.result, GoalReached):
                    arrived.add(index)
            ticks += 1
    assert arrived == {0, 1}
    assert_equal_replay(bag, ticks)


@pytest.fixture(scope="module")
def stormed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Visited]:
    with pytest.MonkeyPatch.context() as monkeypatch:
        session = Visited(setting_of(1), tmp_path_factory.mktemp("storm") / "storm.bag", monkeypatch)
        with session.writer:
            yield session


TREES = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats() | st.text(max_size=9) | st.binary(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=9), inner, max_size=3),
    max_leaves=6,
)


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(st.data())
def test_no_bytes_and_no_values_at_any_door_make_it_raise(stormed: Visited, data: st.DataObject) -> None:
    topic = data.draw(st.sampled_from(sorted(stormed.doors.heard)))
    stormed.say(topic, data.draw(st.binary(max_size=300)), data.draw(st.text(max_size=9)))
    stormed.call(data.draw(st.sampled_from(sorted(stormed.doors.services))), data.draw(st.binary(max_size=600)))
    keys = sorted(below(stormed.doors.declared["/robot1"], "/robot1"))
    key = data.draw(st.sampled_from(keys)) + data.draw(st.sampled_from(["", "/", "/new", "//", "/ü"]))
    stormed.set_parameter(key, data.draw(TREES))
    stormed.step()
