"""Fleet of real Nav2 robots on a ROS 2 graph, which is used as a team. It adds a carrier to `RemoteTeam`."""

import asyncio
import logging
import struct
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Protocol

from thbridge.ros import names
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import types
from thbridge.ros.reconfigure import DescribedParameter
from thbridge.ros.remote.clock import RosClock
from thbridge.ros.remote.names import Nav2Names
from thbridge.ros.remote.robot import RemoteRobot
from thbridge.ros.remote.team import RemoteTeam
from thbridge.ros.topics import RosMessage, Topic
from thbridge.ros2.action_messages import pose_stamped_of
from thbridge.ros2.actions import CancelAnswer, GoalInfo
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.nav2_goals import Nav2Cancel, Nav2Goal, Nav2Goals
from thbridge.ros2.navigate_to_pose import NAVIGATE_TO_POSE
from thbridge.ros2.qos import DEFAULT, LATCHED, TF, DeliveryReliability, QosProfile
from thbridge.ros2.topics import TWIST, TWIST_STAMPED, converter_from_ros1, converter_to_ros1, type_of_ros1
from thbridge.ros2graph.sockets.action_client import GraphActionClient
from thbridge.ros2graph.sockets.carrier import GraphCarrier
from thbridge.ros2graph.sockets.joining import NodeTaken, find_nodes
from thbridge.ros2graph.sockets.nav2_fleet_parameters import Nav2FleetParameters
from thbridge.ros2graph.values.graph import EndpointRole, GraphEndpoint, NodeName
from thbridge.sockets.errors import CannotListen, CannotReach
from thbridge.sockets.warn_once import WarnOnce

NODE = NodeName("/", names.FLEET[1:])
TEAM_TOPICS = {names.MAP: types.OCCUPANCY_GRID, names.ROSOUT: types.LOG, names.DIAGNOSTICS: types.DIAGNOSTIC_ARRAY}
"""Recorded topics that do not belong to a single robot, with their types in ROS 1."""
LOOK_TICKS = 50
"""Ticks between two looks at the types of the graph's publishers."""
STOP_SECONDS = 1.0
"""Maximum time for which the program waits for the answers to its last cancel requests."""

_STREAM = QosProfile(10, DeliveryReliability.BEST_EFFORT)
"""Publishers with any quality of service satisfy this."""
_TIME = struct.Struct("<iI")

_log = logging.getLogger(__name__)


class Nav2Recorder(Protocol):
    """Recorder of messages from and to the robots, in the form of ROS 1. It must not raise exceptions."""

    def received(self, topic: Topic, publisher: str, stamp_ns: int, data: bytes) -> None:
        """Record a received message at this ROS time. `publisher` is the name of its node."""

    def sent(self, message: RosMessage) -> None:
        """Record a message sent to a robot."""


@dataclass(slots=True, eq=False)
class Nav2Robot:
    """Real robot with its names on the graph.

    Attributes:
        remote: its state and messages. Its action server has the name `ACTION/_action`.
        named: further names.
        goals: its action, in the form of ROS 1.
    """

    remote: RemoteRobot
    named: Nav2Names
    goals: Nav2Goals

    @property
    def velocity_type(self) -> str:
        """Type of the commands to its base."""
        return TWIST_STAMPED if self.named.is_twist_stamped else TWIST


@dataclass(slots=True, eq=False)
class _Subscription:
    """Subscribed topic.

    Attributes:
        topic: its name on the graph, and its type in ROS 1.
        kind: its type.
        receivers: robots that read it, each with the name of the topic in ROS 1.
        reads_latched: True if a second subscription reads the messages of latched publishers.
        latched: gids of these publishers.
    """

    topic: Topic
    kind: str
    receivers: list[tuple[RemoteRobot, str]] = field(default_factory=list)
    reads_latched: bool = False
    latched: frozenset[bytes] = frozenset()


class Nav2Fleet(RemoteTeam):
    """Team of real robots on a ROS 2 graph.

    Args:
        carrier: connection to their graph, before it is started.
        distribution: message types of the graph.
        robots: the robots.
        recorder: recorder of all messages.
        offset: time by which odometry is ahead of the scans. Its default is the value at the start.
        is_time_simulated: True if time comes from /clock (ROS: use_sim_time).
        wall: returns the time of the wall clock, nanoseconds.
    """

    def __init__(
        self,
        carrier: GraphCarrier,
        distribution: Distribution,
        robots: Sequence[Nav2Robot],
        recorder: Nav2Recorder,
        offset: DescribedParameter,
        *,
        is_time_simulated: bool = False,
        wall: Callable[[], int] = time.time_ns,
    ) -> None:
        super().__init__([robot.remote for robot in robots], offset, wall)
        self._carrier = carrier
        self._distribution = distribution
        self._robots = tuple(robots)
        self._recorder = recorder
        self._complaints = WarnOnce(_log)
        self._ticks = 0
        self._waiting_cancels = 0
        self.clock = clock = RosClock(is_time_simulated)
        carrier.add_node(NODE)
        self._parameters = Nav2FleetParameters(
            carrier,
            distribution,
            NODE,
            offset,
            self.correct_odometry,
            self.now,
            is_time_simulated=is_time_simulated,
        )
        self._is_rejected = False
        if is_time_simulated:
            support = distribution.message("rosgraph_msgs/msg/Clock")
            carrier.subscribe(NODE, names.CLOCK, support, _STREAM, partial(self._receive_clock, clock))
        self._clients = [self._client(robot) for robot in self._robots]
        self._writers: dict[str, Callable[[RosMessage], None]] = {}
        for robot in self._robots:
            topics = robot.remote.names
            for topic, ros1_type, kind in (
                (topics.initialpose, types.POSE_WITH_COVARIANCE, type_of_ros1(types.POSE_WITH_COVARIANCE)),
                (topics.cmd_vel, types.TWIST, robot.velocity_type),
            ):
                self._writers[topic] = self._writer(topic, ros1_type, kind)
        self._subscribed: dict[str, _Subscription] = {}
        for robot in self._robots:
            for name, kind in robot.remote.subscriptions.items():
                self._add_receiver(robot, name, kind)
        for name, kind in TEAM_TOPICS.items():
            shared = Topic(name, kind, latched=name == names.MAP)
            self._subscribed.setdefault(name, _Subscription(shared, type_of_ros1(kind)))
        self._listens = False
        if not is_time_simulated:
            self._listen()
        self._unknown = {name for robot in self._robots for name in robot.remote.names.recorded} - {*self._subscribed}

    async def start(self) -> CannotListen | CannotReach | NodeTaken | None:
        """Join the graph. Robots may appear later. If another program has the fleet's node, leave the graph again."""
        failure = await self._carrier.start()
        if failure is not None:
            return failure
        if await find_nodes(self._carrier, lambda name: name == NODE.whole):
            self._is_rejected = True
            await self._carrier.stop()
            return NodeTaken(NODE.whole)
        self._parameters.announce()
        return None

    async def stop(self) -> None:
        """Stop the robots, and leave the graph."""
        if self._is_rejected:
            return  # The robots belong to the other program.
        self._stop_robots()
        for _ in range(round(STOP_SECONDS / 0.02)):
            if not self._waiting_cancels:
                break
            await asyncio.sleep(0.02)
        await self._carrier.stop()

    def missing(self) -> list[str]:
        """Return the reasons why the robots cannot be commanded yet. Each reason is one sentence."""
        if self.now() is None:
            return [f"use_sim_time is set, but there is no time on {names.CLOCK} yet"]
        return super().missing()

    def tell_changes(self) -> None:
        """Process the state of the graph, and log changes of the robots; see `RemoteTeam`."""
        if self._ticks % LOOK_TICKS == 0:
            self._look_at_publishers()
        self._ticks += 1
        if (now_ns := self.now()) is not None:
            self._follow_actions(now_ns)
        super().tell_changes()

    # Actions

    def _client(self, robot: Nav2Robot) -> GraphActionClient:
        goals = robot.goals
        return GraphActionClient(
            self._carrier,
            NODE,
            robot.named.action,
            self._distribution,
            NAVIGATE_TO_POSE,
            lambda goal_id, _: goals.receive_feedback(goal_id, self.now() or 0),
            lambda statuses: goals.receive_statuses(statuses, self.now() or 0),
        )

    def _follow_actions(self, now_ns: int) -> None:
        """Hand over the messages of the robots' actions."""
        for robot, client in zip(self._robots, self._clients, strict=True):
            for part, data in robot.goals.step(now_ns, has_server=client.has_server):
                name = robot.remote.names.action(part)
                robot.remote.receive(name, data, now_ns)
                self._record(RosMessage(Topic(name, robot.remote.subscriptions[name]), now_ns, data))

    def _send(self, robot: int, message: RosMessage) -> None:
        named, client = self._robots[robot], self._clients[robot]
        match named.goals.request_of(message):
            case Nav2Goal(goal_id, base_in_map):
                frame = named.remote.names.map_frame
                pose = pose_stamped_of(self._distribution, frame, message.stamp_ns, base_in_map)
                goal = self._distribution.make(f"{NAVIGATE_TO_POSE}_Goal", pose=pose)
                client.send_goal(goal_id, goal, partial(self._answered, named, client, goal_id))
            case Nav2Cancel(goal_id):
                self._waiting_cancels += 1
                client.cancel(GoalInfo(goal_id, 0), self._canceled)
            case None:
                self._writers[message.topic.name](message)

    def _record(self, message: RosMessage) -> None:
        # ROS 2 itself uses names with "_action".
        name = message.topic.name.replace("/_action/", "/")
        self._recorder.sent(message._replace(topic=message.topic._replace(name=name)))

    def _answered(self, robot: Nav2Robot, client: GraphActionClient, goal_id: bytes, accepted_ns: int | None) -> None:
        robot.goals.receive_answer(goal_id, accepted=accepted_ns is not None)
        if accepted_ns is not None:
            client.get_result(goal_id, lambda result: robot.goals.receive_result(goal_id, result, self.now() or 0))

    def _canceled(self, answer: CancelAnswer) -> None:
        self._waiting_cancels -= 1

    # Topics

    def _writer(self, topic: str, ros1_type: str, kind: str) -> Callable[[RosMessage], None]:
        """Return a function that publishes messages of ROS 1 on a topic."""
        writer = self._carrier.publish(NODE, topic, self._distribution.message(kind), DEFAULT)
        convert = converter_from_ros1(self._distribution, ros1_type, kind)
        return lambda message: writer.write(convert(message))

    def _add_receiver(self, robot: Nav2Robot, name: str, ros1_type: str) -> None:
        remote, named = robot.remote, robot.named
        if name.startswith(f"{named.action}/_action/"):
            return  # These messages are made from the action.
        on_graph = {names.TF: named.tf, names.TF_STATIC: named.tf_static}.get(name, name)
        topic = Topic(on_graph, ros1_type, latched=name == names.TF_STATIC)
        kind = robot.velocity_type if name == remote.names.cmd_vel else type_of_ros1(ros1_type)
        subscription = self._subscribed.setdefault(on_graph, _Subscription(topic, kind))
        subscription.receivers.append((remote, name))

    def _listen(self) -> None:
        """Subscribe to all topics when the time is known. Latched messages that arrived earlier would be lost."""
        self._listens = True
        for subscription in self._subscribed.values():
            self._subscribe(subscription)

    def _subscribe(self, subscription: _Subscription, *, from_latched: bool = False) -> None:
        """Subscribe to a topic; if `from_latched` is True, to the last messages of its latched publishers."""
        name, ros1_type, _ = subscription.topic
        convert = converter_to_ros1(self._distribution, subscription.kind, ros1_type)

        def on_message(data: bytes, gid: bytes) -> None:
            now_ns = self.now()
            if now_ns is None or (gid in subscription.latched) is not from_latched:
                return
            publisher = self._carrier.node_of(gid)
            try:
                message = convert(data)
            except ValueError as error:
                self._complaints.warn(f"{name}: a message of {publisher} is ignored: {error}")
                return
            self._recorder.received(subscription.topic, publisher, now_ns, message)
            for remote, topic in subscription.receivers:
                if isinstance(refused := remote.receive(topic, message, now_ns), InvalidMessage):
                    self._complaints.warn(f"{name}: a message of {publisher} is ignored: {refused.sentence}")

        qos = {types.TFMESSAGE: TF, types.OCCUPANCY_GRID: LATCHED}.get(ros1_type, _STREAM)
        if subscription.topic.latched or from_latched:
            qos = LATCHED
        support = self._distribution.message(subscription.kind)
        self._carrier.subscribe(NODE, name, support, qos, on_message)

    def _look_at_publishers(self) -> None:
        """Subscribe to topics as their publishers require, and report publishers of other types than expected."""
        publishers = [each for each in self._carrier.endpoints() if each.role is EndpointRole.PUBLISHER]
        if self._listens:
            self._read_latched_poses(publishers)
        for endpoint in publishers:
            known = self._subscribed.get(endpoint.name)
            if known is not None and known.kind != endpoint.type:
                who = "a node" if endpoint.node is None else endpoint.node.whole
                self._complaints.warn(
                    f"{endpoint.name}: {who} publishes {endpoint.type}, but {known.kind} was expected"
                )
            elif self._listens and endpoint.name in self._unknown:
                self._unknown.discard(endpoint.name)
                package, _, word = endpoint.type.split("/")
                subscription = _Subscription(Topic(endpoint.name, f"{package}/{word}"), endpoint.type)
                try:
                    self._subscribe(subscription)
                except KeyError:
                    self._complaints.warn(f"{endpoint.name} is not recorded, because ROS 1 has no {endpoint.type}")
                else:
                    self._subscribed[endpoint.name] = subscription

    def _read_latched_poses(self, publishers: Sequence[GraphEndpoint]) -> None:
        """Read poses of latched publishers by a latched subscription.

        Nav2's amcl publishes the pose of a standing robot once, latched. Other localizations may not be latched, and a
        latched subscription does not match these.
        """
        for robot in self._robots:
            pose = self._subscribed[robot.remote.names.amcl_pose]
            pose.latched = frozenset(
                each.gid for each in publishers if each.name == pose.topic.name and each.qos.satisfies(LATCHED)
            )
            if pose.latched and not pose.reads_latched:
                pose.reads_latched = True
                self._subscribe(pose, from_latched=True)

    def _receive_clock(self, clock: RosClock, data: bytes, gid: bytes) -> None:
        if len(data) != 4 + _TIME.size or data[1] != 1:
            self._complaints.warn(f"{names.CLOCK}: a message of {self._carrier.node_of(gid)} is ignored")
            return
        seconds, nanoseconds = _TIME.unpack_from(data, 4)
        clock.receive(seconds * 1_000_000_000 + nanoseconds, self._wall())
        if not self._listens:
            self._listen()
