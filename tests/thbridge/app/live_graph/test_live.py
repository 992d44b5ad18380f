"""What clients ask of a session on a graph: how much of it comes in, and as what."""

import asyncio
import dataclasses
import logging
import struct
from collections.abc import Iterator
from pathlib import Path

import pytest

from sim.common.observations import Twist
from sim.inputs import NomotionUpdate
from tests.support.ros.packed_messages import stamped
from tests.thbridge.app.live_graph.visited_session import Visited, asked, cancel, goal
from thbridge.app.compose.setting import read_setting
from thbridge.app.live_graph.rate_limiter import REQUESTS_PER_TICK
from thbridge.app.session.inputs import FrameReceived
from thbridge.app.session.mavros import frame_record
from thbridge.mavlink.wire.dialect import crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.mavlink.wire.traffic import Traffic
from thbridge.roles.shared.robot_requests import SetParameters
from thbridge.ros.messages import pack, unpack
from thbridge.ros.messages.records import CancelRequest, GoalRequest, SimpleGoal, VelocityCommand
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.names import CALLER
from thbridge.ros.parameters import leaves
from thbridge.rosgraph.wire.links import ServiceFailed
from thbridge.study.external_nodes import ExternalNodes
from thbridge.study.mavlink import MavlinkSection
from thbridge.study.study_file import Study

FORWARD = struct.pack("<6d", 0.1, 0, 0, 0, 0, 0)


@pytest.fixture
def visited(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Visited]:
    setting = read_setting(dataclasses.replace(Study(), robots=2), Path())
    session = Visited(setting, tmp_path / "hunt.bag", monkeypatch)
    with session.writer:
        yield session


def test_a_client_that_floods_a_topic_gets_in_so_often_a_tick_and_the_log_says_so_once(
    visited: Visited, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        for _ in range(2):
            for _ in range(500):
                visited.say("/robot1/move_base_simple/goal", stamped(), "/flood")
            assert len(asked(visited.step())) == REQUESTS_PER_TICK
    told = [line.getMessage() for line in caplog.records]
    assert len(told) == 1
    assert "/flood" in told[0]
    assert "/robot1/move_base_simple/goal" in told[0]


def test_a_flood_costs_nobody_else_a_request(visited: Visited) -> None:
    for _ in range(500):
        visited.say("/robot1/cmd_vel", FORWARD, "/flood")
    visited.say("/robot1/cmd_vel", FORWARD, "/joystick")
    visited.say("/robot2/cmd_vel", FORWARD, "/flood")
    visited.say("/robot1/move_base_simple/goal", stamped(), "/flood")
    requests = asked(visited.step())
    assert sum(item == VelocityCommand(0, Twist(0.1, 0.0)) for item in requests) == REQUESTS_PER_TICK + 1
    assert VelocityCommand(1, Twist(0.1, 0.0)) in requests
    assert isinstance(requests[-1], SimpleGoal)


def test_what_is_the_same_once_and_often_is_asked_once_and_answered_every_time(visited: Visited) -> None:
    assert [visited.call("/robot1/request_nomotion_update") for _ in range(50)] == [b""] * 50
    assert asked(visited.step()) == [NomotionUpdate(0)]
    visited.call("/robot1/request_nomotion_update")
    assert asked(visited.step()) == [NomotionUpdate(0)]


def test_a_frame_on_a_robots_topic_is_heard_by_that_robot_and_none_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    study = dataclasses.replace(Study(), robots=2, mavlink=MavlinkSection(on=True))
    visited = Visited(read_setting(study, Path()), tmp_path / "hunt.bag", monkeypatch)
    beat = mav.MAVLink_heartbeat_message(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 0, 3)
    frame = Frame(255, 190, 7, beat.id, payload_of(beat), crc_extra(beat.id) or 0)
    said = pack.mavlink(0, frame_record(Traffic(0, True, "whatever it was called", frame)).frame)
    with visited.writer:
        visited.step()
        visited.say("/robot2/mavlink/to", said, "/gcs_bridge")
        visited.say("/robot2/mavlink/to", said, CALLER)  # What other links brought, which we say there.
        tick_record = visited.step()
        assert tick_record.inputs == (FrameReceived(LinkId(0), "ros", frame, 1),)
        assert [(item.robot, item.frame) for item in tick_record.traffic if item.incoming] == [(1, frame)]
        with caplog.at_level(logging.WARNING):
            visited.say("/robot2/mavlink/to", said[:-30], "/gcs_bridge")
        assert visited.step().inputs == ()
    assert "/robot2/mavlink/to: ignoring a message of /gcs_bridge" in caplog.text


def test_a_flood_of_estimates_is_told_no(visited: Visited) -> None:
    estimate = stamped() + bytes(36 * 8)
    answers = [visited.call("/robot1/set_pose", estimate) for _ in range(50)]
    assert answers.count(b"") == REQUESTS_PER_TICK
    assert isinstance(answers[-1], ServiceFailed)
    assert len(asked(visited.step())) == REQUESTS_PER_TICK


def test_of_many_questions_about_plans_one_is_answered_at_a_turn(visited: Visited) -> None:
    visited.step()
    question = stamped(x=2.0, y=0.0) + stamped(x=-2.0, y=0.0) + struct.pack("<f", 0.0)

    async def longest_turn() -> int:
        pending = [
            asyncio.ensure_future(visited.doors.services["/robot1/move_base/make_plan"](question)) for _ in range(8)
        ]
        longest = done = 0
        while done < len(pending):
            await asyncio.sleep(0)
            now = sum(each.done() for each in pending)
            longest, done = max(longest, now - done), now
        assert all(each.result() == pending[0].result() for each in pending)
        return longest

    assert asyncio.run(longest_turn()) == 1


def test_a_client_whose_clock_is_ahead_shuts_nobody_out(visited: Visited) -> None:
    for _ in range(50):
        visited.step()
    for topic, data in (("goal", goal(2.0, 0.0, "ahead", 2**30)), ("cancel", cancel("ahead", 2**30))):
        visited.say(f"/robot1/move_base/{topic}", data, "/wall_clock")
    first, second = asked(visited.step())
    assert isinstance(first, GoalRequest)
    assert isinstance(second, CancelRequest)
    assert first.stamp_ns == second.stamp_ns <= stamp_ns(51)
    visited.say("/robot1/move_base/goal", goal(2.0, 0.0, "late", 1), "/rviz")
    (late,) = asked(visited.step())
    assert isinstance(late, GoalRequest)
    assert late.stamp_ns == 1_000_000_000


def test_a_mistake_is_told_once_however_often_it_is_made(visited: Visited, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        for _ in range(5):
            visited.say("/robot1/move_base_simple/goal", stamped("odom"))
            assert asked(visited.step()) == []
    assert len(caplog.records) == 1


def test_the_graph_is_told_of_parameters_that_others_change(visited: Visited) -> None:
    visited.ask("window", SetParameters(1, (("amcl.kld_err", 0.25), ("world.gyro_noise", 0.5))))
    visited.step()
    declared = visited.doors.declared
    assert declared["/robot2/amcl/kld_err"] == 0.25
    assert "/robot1/amcl/kld_err" not in declared


@pytest.fixture(params=["move_base", "both"])
def left_to_others(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Visited]:
    study = dataclasses.replace(Study(), robots=2, external_nodes=ExternalNodes(request.param))
    session = Visited(read_setting(study, Path()), tmp_path / "hunt.bag", monkeypatch)
    with session.writer:
        yield session


def test_nodes_that_others_run_have_their_topics_services_and_transforms_to_themselves(
    left_to_others: Visited, request: pytest.FixtureRequest
) -> None:
    doors = left_to_others.doors
    both = "both" in request.node.name
    for _ in range(10):
        left_to_others.step()
    names = {*doors.advertised, *doors.services, *doors.heard}
    assert not {name for name in names if "/move_base" in name}
    assert bool({name for name in names if name.endswith(("amcl_pose", "initialpose", "/set_map"))}) is not both
    assert "/robot1/cmd_vel" in doors.heard
    assert "/robot1/cmd_vel" not in doors.advertised
    assert {"/robot1/odom", "/robot1/scan", "/robot2/base_pose_ground_truth", "/tf", "/map"} <= {*doors.advertised}
    frames = [(each.parent, each.child) for _, each in unpack.transforms(doors.advertised["/tf"].last)]
    assert ("robot1/odom", "robot1/base_footprint") in frames
    assert (("map", "robot1/odom") in frames) is not both
    told = doors.declared.get("/robot2/amcl/initial_pose_x")
    assert told == (pytest.approx(left_to_others.robots().truth.poses[1][0], abs=0.05) if both else None)
    assert dict(leaves("/robot1", doors.declared["/robot1"]))["/robot1/move_base/controller_frequency"] == 10.0


def test_others_drive_such_a_robot_by_cmd_vel_and_turn_their_own_parameters(left_to_others: Visited) -> None:
    for _ in range(20):
        left_to_others.say("/robot1/cmd_vel", FORWARD)
        left_to_others.step()
    assert left_to_others.robots().truth.twists[0][0] == pytest.approx(0.1, abs=0.02)
    declared = dict(left_to_others.doors.declared)
    left_to_others.set_parameter("/robot1/move_base/planner_patience", 1.0)
    assert asked(left_to_others.step()) == []
    assert left_to_others.doors.declared == declared, "nothing is put back"
