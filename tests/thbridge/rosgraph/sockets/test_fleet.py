"""A fleet over real TCP: robots played by a node of their own, at our own master."""

import asyncio
import math
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from functools import wraps
from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Reader

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL
from sim.inputs import KidnapRobot, PlaceRobot, SendGoal, SetCharge
from sim.parameters import live_parameters
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, NoPath
from sim.snapshot import TeamSnapshot
from tests.support.programs.event_loops import eventually
from tests.support.ros.service_client import call_service
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros import names
from thbridge.ros.messages import pack, types, unpack
from thbridge.ros.messages.goal_status import ENDED, GoalId, GoalStatus, GoalStatusCode
from thbridge.ros.messages.records import SendRobots
from thbridge.ros.messages.session_records import InputRecord, SessionRecord
from thbridge.ros.reconfigure import described, values_config
from thbridge.ros.remote.names import RemoteNames
from thbridge.ros.remote.robot import RemoteRobot
from thbridge.ros.topics import RosMessage, Topic
from thbridge.rosgraph.files.real_robots import FleetRecorder
from thbridge.rosgraph.sockets.fleet import Fleet
from thbridge.rosgraph.sockets.http_client import XmlRpcClient
from thbridge.rosgraph.sockets.joining import GraphAddress
from thbridge.rosgraph.sockets.master_server import MasterServer
from thbridge.rosgraph.sockets.node import NodeStarted, RosNode
from thbridge.rosgraph.wire.links import ServiceFailed
from thbridge.sockets.addresses import ListeningAddress
from thbridge.study.real_robots import FleetNames, FleetSection

PATIENCE = 120.0
SESSION = SessionRecord("robots_from: ros\n", 1, {}, "simr", ("SimR",), "")
NAMED = FleetNames().names(1)
GOAL = Goal(5, Pose2(2.0, 0.0, 0.0))


class Actor:
    """Plays one robot: drives to whatever goal it gets, and says what real ones say.

    Attributes:
        obeys: what becomes of goals; None: nothing.
        mute: topics on which it says nothing.
        speed: m/s by its odometry.
    """

    def __init__(
        self, uri: str, named: RemoteNames = NAMED, name: str = "/robot", hears: bool = True, speed: float = 0.0
    ) -> None:
        self.node = RosNode(name, uri)
        self.named = named
        self.obeys: GoalStatusCode | None = GoalStatusCode.SUCCEEDED
        self.mute: set[str] = set()
        self.speed = speed
        self.goals: list[str] = []
        self.cancelled: list[str] = []
        self.listed: list[GoalStatus] = []
        self.tick = 0
        self.out = {
            topic: self.node.advertise(topic, kind, types.plain_definition(kind).md5, types.plain_definition(kind).text)
            for topic, kind in (
                (named.odom, types.ODOMETRY),
                (named.amcl_pose, types.POSE_WITH_COVARIANCE),
                (named.action("status"), types.GOAL_STATUS_ARRAY),
                (named.action("result"), types.MOVE_BASE_RESULT),
                (names.TF_STATIC, types.TFMESSAGE),
            )
        }
        if hears:
            self.listen()

    def listen(self) -> None:
        named = self.named
        for part, kind, heard in (("goal", types.MOVE_BASE_GOAL, self._goal), ("cancel", types.GOAL_ID, self._cancel)):
            self.node.subscribe(named.action(part), kind, types.plain_definition(kind).md5, heard)

    def _goal(self, data: bytes, publisher: str) -> None:
        assert publisher == names.FLEET
        self.goals.append(unpack.move_base_goal(data).goal_id)
        self.listed = [GoalStatus(GoalId(self.goals[-1], 0), GoalStatusCode.ACTIVE, "")]

    def _cancel(self, data: bytes, publisher: str) -> None:
        self.cancelled.append(unpack.goal_id(data).id)
        self.listed = [entry._replace(status=GoalStatusCode.PREEMPTED) for entry in self.listed]

    async def live(self) -> None:
        while True:
            self.tick += 1
            named, tick = self.named, self.tick
            for topic, data in (
                (
                    named.odom,
                    pack.odometry(tick, named.odom_frame, "", Pose2(0.02 * tick * self.speed, 0, 0), STANDSTILL),
                ),
                (named.amcl_pose, pack.pose_with_covariance(tick, "map", Pose2(1, 2, 0), np.eye(3))),
                (named.action("status"), pack.goal_status_array(tick, self.listed)),
            ):
                if topic not in self.mute:
                    self.out[topic].publish(data)
            if self.obeys is not None and self.listed and self.listed[0].status not in ENDED:
                self.listed = [self.listed[0]._replace(status=self.obeys, text="so be it")]
                self.out[named.action("result")].publish(pack.move_base_result(tick, self.listed[0]))
            await asyncio.sleep(0.02)


class Notes:
    """A recorder that keeps names of topics and publishers."""

    def __init__(self) -> None:
        self.came: list[tuple[str, str]] = []
        self.went: list[str] = []
        self.messages: list[RosMessage] = []

    def received(self, topic, publisher, stamp_ns, data):
        self.came.append((topic.name, publisher))

    def sent(self, message):
        self.went.append(message.topic.name)
        self.messages.append(message)


def with_patience(test: Callable[..., Awaitable[None]]) -> Callable[..., None]:
    @wraps(test)
    def run(*args, **kwargs) -> None:
        async def patient() -> None:
            async with asyncio.timeout(PATIENCE):
                await test(*args, **kwargs)

        asyncio.run(patient())

    return run


@asynccontextmanager
async def master() -> AsyncIterator[MasterServer]:
    made = MasterServer(port=0)
    assert isinstance(await made.start(), ListeningAddress)
    try:
        yield made
    finally:
        await made.stop()


@asynccontextmanager
async def alive(actor: Actor) -> AsyncIterator[Actor]:
    assert isinstance(await actor.node.start(), NodeStarted)
    task = asyncio.create_task(actor.live())
    try:
        yield actor
    finally:
        task.cancel()
        await asyncio.wait([task])
        await actor.node.stop()


@asynccontextmanager
async def fleet_at(uri: str, recorder: object, wall: Callable[[], int] = time.time_ns) -> AsyncIterator[Fleet]:
    (offset,) = live_parameters(FleetSection)
    robots = [RemoteRobot(0, NAMED, names.FLEET, np.zeros((0, 2)))]
    fleet = Fleet(GraphAddress(uri), robots, recorder, described(offset), wall)
    assert isinstance(await fleet.start(), NodeStarted)
    try:
        yield fleet
    finally:
        await fleet.stop()


async def ended(fleet: Fleet, *inputs: SendGoal) -> object:
    """Ask, and go on until a goal ends."""
    snapshot = fleet.step(inputs)
    while (result := snapshot.robots[0].navigation.result) is None:
        await asyncio.sleep(0.01)
        snapshot = fleet.step()
    return result


@with_patience
async def test_it_waits_for_master_and_robots_says_for_which_and_goes_on_when_they_come():
    async with master() as probe:
        uri = probe.uri
    async with fleet_at(uri, Notes()) as fleet:
        assert fleet.missing() == [f"there is no ROS master at {uri} yet"]
        with pytest.raises(ValueError, match="not known"):
            fleet.step()
        again = MasterServer(port=int(uri.rstrip("/").rpartition(":")[2]))
        assert isinstance(await again.start(), ListeningAddress)
        await eventually(lambda: "/robot1/odom" in fleet.missing()[0])
        async with alive(Actor(uri)):
            await eventually(lambda: not fleet.missing())
            snapshot = fleet.step()
            assert (snapshot.world, snapshot.robots[0].estimate.base_in_map) == (None, Pose2(1, 2, 0))
        await again.stop()


@with_patience
async def test_a_robot_that_cannot_hear_goals_is_waited_for():
    async with master() as ros, alive(Actor(ros.uri, hears=False)) as actor, fleet_at(ros.uri, Notes()) as fleet:
        await eventually(lambda: "robot 1 does not subscribe to /robot1/move_base/goal" in fleet.missing()[0])
        assert "--ros-host" in fleet.missing()[0]
        actor.listen()
        await eventually(lambda: not fleet.missing())


@with_patience
async def test_goals_reach_the_robot_and_their_ends_come_back():
    notes = Notes()
    async with master() as ros, alive(Actor(ros.uri)) as actor, fleet_at(ros.uri, notes) as fleet:
        await eventually(lambda: not fleet.missing())
        assert await ended(fleet, SendGoal(0, GOAL)) == GoalReached(GOAL)
        actor.obeys = GoalStatusCode.ABORTED
        assert await ended(fleet, SendGoal(0, GOAL)) == NoPath(GOAL, "gave_up", "so be it")
        actor.obeys = None
        fleet.step([SendGoal(0, GOAL)])
        await eventually(lambda: len(actor.goals) == 3)
        assert await ended(fleet, SendGoal(0, Goal(6, Pose2(0, 0, 0)))) == Cancelled(GOAL)
        assert notes.went.count("/robot1/move_base/goal") == 4
        assert ("/robot1/move_base/goal", names.FLEET) not in notes.came
        assert ("/robot1/odom", "/robot") in notes.came


@with_patience
async def test_a_robot_whose_node_is_restarted_gets_its_goal_again_which_is_told(caplog):
    async with master() as ros, fleet_at(ros.uri, Notes()) as fleet:
        async with alive(Actor(ros.uri)) as actor:
            actor.obeys = None
            await eventually(lambda: not fleet.missing())
            fleet.step([SendGoal(0, GOAL)])
            await eventually(lambda: actor.goals and fleet.step())
        async with alive(Actor(ros.uri)) as reborn:
            assert await ended(fleet) == GoalReached(GOAL)
            assert len(reborn.goals) == 1
            assert reborn.goals != actor.goals
    told = [record.getMessage() for record in caplog.records]
    assert told == ["robot 1: its navigation did not report its goal, so the goal is sent again"]


@with_patience
async def test_what_falls_silent_and_comes_back_is_told_once_for_each_robot(caplog):
    notes, later_ns = Notes(), 0

    async def passes(seconds: float, *heard: str) -> list[str]:
        """Let time pass, then hear from the robot again; return what is told meanwhile."""
        nonlocal later_ns
        caplog.clear()
        later_ns += round(seconds * 1e9)
        notes.came.clear()
        while not {(topic, "/robot") for topic in heard} <= set(notes.came):
            await asyncio.sleep(0.01)
        for _ in range(10):
            fleet.step()
        return [record.getMessage() for record in caplog.records]

    odom, status = NAMED.odom, NAMED.action("status")
    async with (
        master() as ros,
        alive(Actor(ros.uri)) as actor,
        fleet_at(ros.uri, notes, lambda: time.time_ns() + later_ns) as fleet,
    ):
        await eventually(lambda: not fleet.missing())
        actor.mute = {status}
        assert await passes(6, odom) == []
        assert await passes(1, odom) == [
            "robot 1: its navigation is silent: no more messages on /robot1/move_base/status"
        ]
        assert await passes(60, odom) == []
        assert await passes(1, odom) == []
        actor.mute = set()
        assert await passes(0, odom, status) == []
        assert await passes(1, odom, status) == ["robot 1: its navigation is back on /robot1/move_base/status"]
        actor.mute = {odom, status, NAMED.amcl_pose}
        assert await passes(6) == []
        assert await passes(1) == [
            "robot 1: it is silent: no more odometry; "
            "its navigation is silent: no more messages on /robot1/move_base/status"
        ]
        actor.mute = set()
        assert await passes(0, odom, status) == []
        assert await passes(1, odom, status) == [
            "robot 1: its odometry is back; its navigation is back on /robot1/move_base/status"
        ]


@with_patience
async def test_robots_stand_when_the_program_ends():
    async with master() as ros, alive(Actor(ros.uri)) as actor:
        actor.obeys = None
        async with fleet_at(ros.uri, Notes()) as fleet:
            await eventually(lambda: not fleet.missing())
            fleet.step([SendGoal(0, GOAL)])
            await eventually(lambda: actor.goals and fleet.step())
        await eventually(lambda: actor.cancelled)
        assert actor.cancelled == actor.goals


@with_patience
async def test_what_only_a_simulation_can_do_is_left_and_told(caplog):
    async with master() as ros, alive(Actor(ros.uri)), fleet_at(ros.uri, Notes()) as fleet:
        await eventually(lambda: not fleet.missing())
        fleet.step([SetCharge(0, 10.0), KidnapRobot(0, Pose2(9, 9, 0))])
        fleet.step([PlaceRobot(0, Pose2(1.1, 2, 0)), PlaceRobot(0, Pose2(5, 5, 0))])
    told = [record.getMessage() for record in caplog.records]
    assert "real robots do not support Carry" in told
    asked = ["robot 1 is not at its start pose: please move it to (5.00, 5.00)"]
    assert [line for line in told if "please" in line] == asked


@with_patience
async def test_a_topic_of_another_type_is_complained_of_and_not_read(caplog):
    async with master() as ros:
        stranger = RosNode("/stranger", ros.uri)
        text = types.plain_definition(types.STRING)
        wrong = stranger.advertise(NAMED.odom, types.STRING, text.md5, text.text, latched=True)
        wrong.publish(pack.string("hello"))
        assert isinstance(await stranger.start(), NodeStarted)
        async with fleet_at(ros.uri, notes := Notes()) as fleet:
            await eventually(lambda: (NAMED.odom, "/stranger") in notes.came)
            assert NAMED.odom in fleet.missing()[0]
        await stranger.stop()
    assert any("std_msgs/String" in record.getMessage() for record in caplog.records)


@with_patience
async def test_time_is_simulated_where_the_graph_says_so_and_it_is_told_when_that_stands(caplog):
    later_ns = 0

    def passes(seconds: float) -> list[str]:
        nonlocal later_ns
        caplog.clear()
        later_ns += round(seconds * 1e9)
        fleet.tell_changes()
        return [record.getMessage() for record in caplog.records]

    async with master() as ros:
        clock = RosNode("/clock_maker", ros.uri)
        text = types.plain_definition(types.CLOCK)
        ticking = clock.advertise(names.CLOCK, types.CLOCK, text.md5, text.text, latched=True)
        clock.declare_param(names.USE_SIM_TIME, True)
        assert isinstance(await clock.start(), NodeStarted)
        await clock.registered()
        async with fleet_at(ros.uri, Notes(), lambda: time.time_ns() + later_ns) as fleet:
            await eventually(lambda: fleet.missing() == ["/use_sim_time is set, but there is no time on /clock yet"])
            ticking.publish(pack.clock(450))
            await eventually(lambda: fleet.now() == 10_000_000_000)
            assert passes(3) == []
            assert passes(1) == ["/clock: no messages; time continues with this machine's clock"]
            assert passes(60) == []
            before_ns = fleet.now()
            ticking.publish(pack.clock(4500))
            await eventually(lambda: fleet.now() > before_ns + 5_000_000_000)
            assert passes(0) == []
            assert passes(1) == ["/clock: messages arrive again"]
        await clock.stop()


OFFSET = f"{names.FLEET}/odom_time_offset"


@with_patience
async def test_the_time_offset_of_odometry_changes_on_the_parameter_server_and_by_dynamic_reconfigure(caplog):
    (offset,) = map(described, live_parameters(FleetSection))
    notes, tuner = Notes(), XmlRpcClient()

    async def on_server() -> object:
        return (await tuner.call(ros.uri, "getParam", "/tuner", OFFSET)).value[2]

    async def becomes(seconds: float, at: float) -> None:
        """Wait until this offset holds for the robot, on the server, and is recorded."""
        while abs(fleet.step().robots[0].estimate.base_in_map.x - at) > 1e-9:
            await asyncio.sleep(0.01)
        while await on_server() != seconds:
            await asyncio.sleep(0.01)
        assert notes.messages[-1].topic == Topic(f"{names.FLEET}/parameter_updates", types.CONFIG, latched=True)
        assert notes.messages[-1].data == values_config([(offset, seconds)])

    async def set_on_server(value: object) -> None:
        await tuner.call(ros.uri, "setParam", "/tuner", OFFSET, value)

    async def set_by_reconfigure(seconds: float) -> bytes | ServiceFailed:
        md5 = types.service_type(types.RECONFIGURE).md5
        return await call_service(ros.uri, f"{names.FLEET}/set_parameters", md5, values_config([(offset, seconds)]))

    async with master() as ros, alive(Actor(ros.uri, speed=1.0)), fleet_at(ros.uri, notes) as fleet:
        await eventually(lambda: not fleet.missing())
        await becomes(0.0, 1.0)
        await set_on_server(0.2)
        await becomes(0.2, 1.2)
        assert await set_by_reconfigure(-0.1) == values_config([(offset, -0.1)])
        await becomes(-0.1, 1.0)  # Of what comes later nothing is known yet.
        assert await set_by_reconfigure(99.0) == values_config([(offset, 10.0)])
        assert await set_by_reconfigure(0.2) == values_config([(offset, 0.2)])
        caplog.clear()
        for wrong in (11.0, "soon", True):
            await set_on_server(wrong)
            await becomes(0.2, 1.2)
        assert await set_by_reconfigure(math.nan) == values_config([(offset, 0.2)])
        assert {record.getMessage() for record in caplog.records} == {
            f"{OFFSET} keeps its value: it must be a number from -10 to 10, not {wrong}"
            for wrong in ("11.0", "'soon'", "True", "nan")
        }
        await set_on_server(1)
        await becomes(1.0, 2.0)
    await tuner.close()


@with_patience
async def test_a_bag_holds_what_robots_said_as_they_said_it_after_the_session(tmp_path: Path):
    path = tmp_path / "real.bag"
    with BagWriter(path, caller=names.FLEET) as writer:
        recorder = FleetRecorder(writer, SESSION)
        async with master() as ros, alive(Actor(ros.uri)) as actor:
            async with fleet_at(ros.uri, recorder) as fleet:
                static = pack.transforms(0, [pack.Transform("robot1/base_footprint", "laser", Pose2(0, 0, 0))])
                while fleet.missing() or not actor.out[names.TF_STATIC].subscribers:
                    recorder.flush()
                    await asyncio.sleep(0.01)
                actor.out[names.TF_STATIC].publish(static)
                records = (InputRecord("heard", "TabUI", "a line", "{}"), SendRobots("%%goto"))
                last: TeamSnapshot = fleet.step([SendGoal(0, GOAL)])
                recorder.record(last, records)
                while not actor.goals or fleet.step().robots[0].navigation.goal is not None:
                    await asyncio.sleep(0.01)
            recorder.flush()
    told = list(messages(path))
    assert told[0].topic == names.SESSION
    assert [message.stamp_ns for message in told] == sorted(message.stamp_ns for message in told)
    assert told[-1].stamp_ns - last.tick * 20_000_000 < 60_000_000_000
    with Reader(path) as reader:
        said_by = {connection.topic: connection.ext.callerid for connection in reader.connections}
        (latched,) = (each.ext.latching for each in reader.connections if each.topic == names.SESSION)
    assert latched == 1
    assert said_by[NAMED.odom] == said_by[names.TF_STATIC] == "/robot"
    assert said_by[NAMED.action("goal")] == said_by[names.INPUTS] == said_by[names.SEND_ROBOTS] == names.FLEET
    (frames,) = (message.data for message in told if message.topic == names.TF_STATIC)
    assert frames == static
