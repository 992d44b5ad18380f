"""Session on a ROS 2 graph under the conventions of Nav2: topics, actions, services and parameters of Nav2's nodes.

As on a ROS 1 graph, a client's message becomes a request, which the session records and processes between two ticks.
"""

from collections.abc import AsyncIterator, Callable, Iterator, Sequence
from contextlib import asynccontextmanager
from functools import partial
from typing import TypeVar

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from sim.robot.global_planning.path import PlanRefusal
from sim.robot.navigator.navigation import Navigation
from sim.team import Team
from thbridge.app.live_graph.client_messages import CLIENT_TOPICS, ClientRequests
from thbridge.app.live_graph.common import OF_AMCL, BegunRecoveries, TeamDescription, without_corrections
from thbridge.app.live_graph.live_node_parameters import LiveNodeParameters
from thbridge.app.live_graph.live_node_services import LiveNodeServices, offer_logger_levels
from thbridge.app.session.mavros import frame_in
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.ros import names
from thbridge.ros.messages import types, unpack
from thbridge.ros.names import CALLER, RobotNames
from thbridge.ros.publisher import clock_message
from thbridge.ros.topics import RosMessage, Topic, VehicleTopics
from thbridge.ros2.compute_path_to_pose import COMPUTE_PATH_TO_POSE, ComputePathServer, MakePlan
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.follow_waypoints import FOLLOW_WAYPOINTS, FollowWaypointsServer
from thbridge.ros2.navigate_to_pose import NAVIGATE_TO_POSE, NavigateToPoseServer
from thbridge.ros2.qos import DEFAULT, Durability
from thbridge.ros2.topics import (
    TWIST,
    TWIST_STAMPED,
    Convert,
    Ros2Topic,
    SessionTopics,
    converter_to_ros1,
    type_of_ros1,
    velocity_type,
)
from thbridge.ros2graph.sockets.action_server import GraphActionServer
from thbridge.ros2graph.sockets.carrier import GraphCarrier, GraphWriter
from thbridge.ros2graph.sockets.joining import carrier_of, find_nodes
from thbridge.ros2graph.sockets.parameter_services import NodeServices
from thbridge.ros2graph.values.address import Ros2Address
from thbridge.ros2graph.values.graph import EndpointRole, NodeName
from thbridge.sockets.admission import Admission
from thbridge.sockets.errors import CannotListen, CannotReach
from thbridge.study.external_nodes import ExternalNodes

R = TypeVar("R")
_LOOK_TICKS = 50
"""Ticks between two looks for publishers of awaited types: one second."""
_UNSENT_TICKS = 5
"""Ticks between two looks for the first subscriptions of latched topics."""


class LiveRos2Graph:
    """Nodes that replace Nav2's nodes and the robots' drivers on a ROS 2 graph.

    Args:
        carrier: connection to the graph, before it is started.
        distribution: message types of the graph.
        description: description of the team.
        team: robots of the team.
        requests: requests of all clients of the session.
        receive_frame: callback with the index of a robot and a MAVLink frame; None if robots are not MAVLink vehicles.
    """

    def __init__(
        self,
        carrier: GraphCarrier,
        distribution: Distribution,
        description: TeamDescription,
        team: Team,
        requests: ClientRequests,
        receive_frame: Callable[[int, Frame], None] | None = None,
    ) -> None:
        self._carrier = carrier
        self._distribution = distribution
        self._team = team
        self._requests = requests
        self._external = description.external
        self._robots = [RobotNames.of(robot) for robot in range(team.size)]
        services = NodeServices(carrier, distribution)
        self._parameters = LiveNodeParameters(
            services,
            team.parameters,
            description.rest,
            description.grid.resolution,
            requests.limiter,
            requests.ask,
            description.external,
        )
        self._nodes = {node.whole: node for node in (NodeName(n.namespace, n.name) for n in self._parameters.nodes)}
        for node in self._nodes.values():
            carrier.add_node(node)
        self._services = LiveNodeServices(
            services,
            distribution,
            self._parameters.nodes,
            description.grid,
            team.costmap,
            requests.limiter,
            requests.ask,
        )
        offer_logger_levels(services, distribution, self._nodes[CALLER])
        self._published: set[str] = set()
        self._topics = {
            name: tuple(self._advertise(name, targets))
            for name, targets in SessionTopics(distribution, description.topics, team.size).targets.items()
        }
        self._actions = [
            _RobotActions(carrier, distribution, robot, requests, partial(_make_plan, team, robot))
            for robot in range(team.size)
            if not self._external.move_base
        ]
        self._action_topics = {name: robot for robot, each in enumerate(self._actions) for name in each.topics}
        self._unsent: set[_TopicWriter] = set()
        self._recoveries = BegunRecoveries(team)
        self._awaited: dict[tuple[str, str], Callable[[], None]] = {}
        for robot, named in enumerate(self._robots):
            self._subscribe_to_clients(robot, named)
            if receive_frame is not None:
                self._subscribe_to_stations(robot, named, receive_frame)

    def _advertise(self, name: str, targets: Sequence[tuple[Ros2Topic, Convert]]) -> Iterator["_TopicWriter"]:
        """Announce the publishers for a topic of the session, except those that belong to nodes of other programs."""
        if self._external.amcl and name.rpartition("/")[2] in OF_AMCL:
            return
        for topic, convert in targets:
            node = self._nodes.get(topic.node)
            if node is not None:
                self._published.add(topic.name)
                writer = self._carrier.publish(node, topic.name, self._distribution.message(topic.type), topic.qos)
                yield _TopicWriter(topic, writer, convert)

    async def join(self) -> CannotListen | CannotReach | Sequence[str]:
        """Join the graph.

        Returns:
            Names of other programs' nodes that already speak for these robots; then this program has left the graph.
            Or the reason why the graph cannot be joined.
        """
        failure = await self._carrier.start()
        if failure is not None:
            return failure
        # Clients publish commands, and external nodes publish transforms. All other topics in the namespace of a robot
        # belong to the robot.
        shared = {"cmd_vel"} if self._external is ExternalNodes.NONE else {"cmd_vel", "tf", "tf_static"}
        own = {
            topic
            for robot in self._robots
            for topic in self._published - {*map(robot.topic, shared), VehicleTopics(robot).received.name}
            if topic.startswith(f"{robot.namespace}/")
        }
        rivals = await find_nodes(self._carrier, self._nodes.__contains__, own)
        if rivals:
            await self._carrier.stop()
        else:
            self._parameters.announce(0)
        return rivals

    async def leave(self) -> None:
        """Leave the graph."""
        await self._carrier.stop()

    def take(self, tick: int, messages: Sequence[RosMessage]) -> None:
        """Publish the messages of one tick; the clock is the first message."""
        self._requests.advance(tick)
        if tick % _LOOK_TICKS == 0:
            self._subscribe_to_awaited()
        self._parameters.follow(tick, self._team.parameters)
        self._services.advance()
        has_amcl = self._external.amcl
        for message in (clock_message(tick), *messages):
            if has_amcl and message.topic.name == names.TF:
                message = message._replace(data=without_corrections(message.data))  # noqa: PLW2901
            if not message.foreign:
                for topic in self._topics.get(message.topic.name, ()):
                    if topic.take(message):
                        self._unsent.add(topic)
        if tick % _UNSENT_TICKS == 0:
            self._unsent = {topic for topic in self._unsent if topic.publish_kept()}
        self._follow_actions(tick, messages)

    def _follow_actions(self, tick: int, messages: Sequence[RosMessage]) -> None:
        own: list[list[RosMessage]] = [[] for _ in self._actions]
        for message in messages:
            robot = self._action_topics.get(message.topic.name)
            if robot is not None:
                own[robot].append(message)
        for robot, (actions, begun) in enumerate(zip(self._actions, self._recoveries.take(), strict=False)):
            actions.follow(tick, own[robot], self._team.navigation(robot), len(begun))

    # Messages of clients

    def _subscribe_to_clients(self, robot: int, named: RobotNames) -> None:
        for topic in CLIENT_TOPICS:
            if topic.ros2 is None or self._external.has(topic.external):
                continue
            name, node = topic.ros2
            own = Topic(named.topic(name), topic.msgtype)
            reader = self._nodes[named.topic(node) if node else CALLER]
            read = partial(self._requests.read, topic, robot)
            subscribe = partial(self._receive, reader, own, read=read, take=self._requests.ask)
            if topic.msgtype == types.TWIST:
                kind = velocity_type(self._distribution)
                other = TWIST if kind == TWIST_STAMPED else TWIST_STAMPED
                self._awaited[own.name, other] = partial(subscribe, kind=other)
            else:
                kind = type_of_ros1(topic.msgtype)
            subscribe(kind=kind)

    def _subscribe_to_awaited(self) -> None:
        """Subscribe to velocity commands of the other type if a program publishes them.

        ROS's tools (`ros2 topic echo`, `ros2 bag record`) refuse a topic that has two types.
        """
        for endpoint in self._carrier.endpoints() if self._awaited else ():
            if endpoint.role is EndpointRole.PUBLISHER:
                subscribe = self._awaited.pop((endpoint.name, endpoint.type), None)
                if subscribe is not None:
                    subscribe()

    def _subscribe_to_stations(self, robot: int, named: RobotNames, receive: Callable[[int, Frame], None]) -> None:
        topic = VehicleTopics(named).received
        self._receive(
            self._nodes[CALLER],
            topic,
            type_of_ros1(topic.msgtype),
            lambda data: frame_in(unpack.mavlink(data)),
            lambda client, frame: receive(robot, frame),
        )

    def _receive(
        self,
        node: NodeName,
        topic: Topic,
        kind: str,
        read: Callable[[bytes], R],
        take: Callable[[str, R], None],
    ) -> None:
        """Subscribe to a topic of clients with a type of ROS 2; see `ClientRequests.receive`."""
        convert = converter_to_ros1(self._distribution, kind, topic.msgtype)

        def on_message(data: bytes, gid: bytes) -> None:
            client = self._carrier.node_of(gid)
            self._requests.receive(topic.name, client, data, lambda cdr: read(convert(cdr)), take)

        self._carrier.subscribe(node, topic.name, self._distribution.message(kind), DEFAULT, on_message)


@asynccontextmanager
async def on_ros2_graph(
    address: Ros2Address,
    admission: Admission,
    description: TeamDescription,
    team: Team,
    requests: ClientRequests,
    receive_frame: Callable[[int, Frame], None] | None = None,
) -> AsyncIterator[tuple[LiveRos2Graph, CannotListen | CannotReach | Sequence[str]]]:
    """Join a graph, and leave it at the end of the context; see `LiveRos2Graph` and `carrier_of`.

    The context yields the nodes, and the outcome of `LiveRos2Graph.join`.
    """
    types_of_graph = Distribution.of(address.distribution.value)
    live = LiveRos2Graph(carrier_of(address, admission), types_of_graph, description, team, requests, receive_frame)
    outcome = await live.join()
    try:
        yield live, outcome
    finally:
        await live.leave()


class _TopicWriter:
    """Publisher of one topic. Messages are converted only if there are subscriptions."""

    def __init__(self, topic: Ros2Topic, writer: GraphWriter, convert: Convert) -> None:
        self._writer = writer
        self._convert = convert
        self._latched = topic.qos.durability is Durability.TRANSIENT_LOCAL
        self._depth = topic.qos.depth
        self._kept: list[RosMessage] = []

    def take(self, message: RosMessage) -> bool:
        """Publish a message. Without subscriptions, keep it if the topic is latched; return True if it is kept."""
        if self._writer.readers:
            self.publish_kept()
            self._writer.write(self._convert(message))
            return False
        if self._latched:
            self._kept = [*self._kept, message][-self._depth :]
        return self._latched

    def publish_kept(self) -> bool:
        """Publish the kept messages if there is a subscription now; return True if they are still kept."""
        if self._kept and self._writer.readers:
            kept, self._kept = self._kept, []
            for message in kept:
                self._writer.write(self._convert(message))
        return bool(self._kept)


class _RobotActions:
    """Action servers of one robot.

    Attributes:
        topics: topics of the session whose messages `follow` needs.
    """

    def __init__(
        self,
        carrier: GraphCarrier,
        distribution: Distribution,
        robot: int,
        requests: ClientRequests,
        make_plan: MakePlan,
    ) -> None:
        named = RobotNames.of(robot)
        self._navigate = NavigateToPoseServer(robot, distribution, requests.messages.numbers, requests.ask)
        self._waypoints = FollowWaypointsServer(distribution, self._navigate)
        self._paths = ComputePathServer(distribution, make_plan)
        self.topics = self._navigate.topics
        self._servers = [
            GraphActionServer(
                carrier,
                NodeName(named.namespace, node),
                named.topic(name),
                distribution,
                action,
                logic,
                requests.limiter.admits,
            )
            for node, name, action, logic in (
                ("bt_navigator", "navigate_to_pose", NAVIGATE_TO_POSE, self._navigate),
                ("waypoint_follower", "follow_waypoints", FOLLOW_WAYPOINTS, self._waypoints),
                ("planner_server", "compute_path_to_pose", COMPUTE_PATH_TO_POSE, self._paths),
            )
        ]

    def follow(self, tick: int, messages: Sequence[RosMessage], navigation: Navigation | None, recoveries: int) -> None:
        """Process a tick of the session; see `NavigateToPoseServer.follow`."""
        self._navigate.follow(tick, messages, navigation, recoveries)
        self._waypoints.follow(tick)
        self._paths.follow(tick)
        for server in self._servers:
            server.publish()


def _make_plan(team: Team, robot: int, start: Pose2 | None, goal: Pose2) -> FloatArray | PlanRefusal:
    """Return a plan of a robot, with the tolerance of its global planner."""
    own = team.parameters[robot]
    tolerances = {
        "navfn/NavfnROS": own.NavfnROS.default_tolerance,
        "global_planner/GlobalPlanner": own.GlobalPlanner.default_tolerance,
    }
    return team.make_plan(robot, start, goal, tolerances.get(own.move_base.base_global_planner, 0.0))
