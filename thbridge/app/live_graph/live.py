"""Session on a ROS graph, which publishes the messages of a bag, and passes clients' requests to the robots.

A client's message does not take effect at once. It becomes a request, which the session records and processes between
two ticks. Queries (for the map or a plan) are answered at once and do not change the state.
"""

import logging
from collections.abc import AsyncIterator, Callable, Iterable
from contextlib import asynccontextmanager
from functools import partial
from typing import TypeVar

import numpy as np

from sim.common.geometry import Pose2
from sim.inputs import ClearCostmaps, GlobalLocalization, NomotionUpdate, SetPoseEstimate
from sim.numerics.float_array import FloatArray
from sim.robot.global_planning.path import PlanRefusal as NoPlan
from sim.team import Team
from thbridge.app.live_graph.client_messages import CLIENT_TOPICS, ClientRequests
from thbridge.app.live_graph.common import OF_AMCL, BegunRecoveries, TeamDescription, without_corrections
from thbridge.app.live_graph.live_loggers import offer_loggers
from thbridge.app.live_graph.live_parameters import LiveParameters, sendable
from thbridge.app.live_graph.typed_node import TypedNode
from thbridge.app.session.mavros import frame_in
from thbridge.files.ros.definitions import ROS_SHARES, Definitions
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.roles.shared.robot_requests import Request
from thbridge.ros import clients, names
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import pack, types, unpack
from thbridge.ros.names import CALLER, MAP_FRAME, RobotNames
from thbridge.ros.topics import CLOCK, RosMessage, VehicleTopics
from thbridge.rosgraph.sockets.joining import GraphAddress, MasterPresence, ensure_master
from thbridge.rosgraph.sockets.node import NodeStarted, RosNode
from thbridge.rosgraph.sockets.request_queue import RequestQueue
from thbridge.rosgraph.wire.links import ServiceFailed
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.warn_once import WarnOnce

R = TypeVar("R")

_log = logging.getLogger(__name__)

NO_POSES: FloatArray = np.empty((0, 3))


class LiveGraph:
    """Node that replaces map_server, amcl, move_base and the robots' drivers.

    Args:
        graph: the ROS graph.
        description: description of the team.
        team: robots of the team.
        requests: requests of all clients of the session.
        receive_frame: callback with the index of a robot and a MAVLink frame; None if robots are not MAVLink vehicles.
    """

    def __init__(
        self,
        graph: GraphAddress,
        description: TeamDescription,
        team: Team,
        requests: ClientRequests,
        receive_frame: Callable[[int, Frame], None] | None = None,
    ) -> None:
        node = RosNode(CALLER, graph.master_uri, graph.host, on_shutdown=self._on_shutdown, admission=graph.admission)
        self._node = TypedNode(node, Definitions(ROS_SHARES))
        self._description = description
        self._team = team
        self._requests = requests
        self._ask = requests.ask
        self._robots = [RobotNames.of(robot) for robot in range(len(team.parameters))]
        self._limiter = requests.limiter
        self._turns = RequestQueue()
        self._complaints = WarnOnce(_log)
        self._tick = 0
        self._external = description.external
        self._publications = {
            topic.name: self._node.advertise(topic.name, topic.msgtype, topic.latched)
            for topic in (CLOCK, *description.topics)
            if not self._is_external(topic.name)
        }
        self._recoveries = BegunRecoveries(team)
        self._recovery_status = [
            self._node.advertise(named.topic("move_base/recovery_status"), types.RECOVERY_STATUS, latched=False)
            for named in self._robots
            if not self._external.move_base
        ]
        self._current_goals = {
            named.topic("move_base/goal"): self._node.advertise(
                named.topic("move_base/current_goal"), types.POSE_STAMPED, latched=False
            )
            for named in self._robots
            if not self._external.move_base
        }
        self._offer_map()
        for robot, named in enumerate(self._robots):
            self._subscribe_to_clients(robot, named)
            if receive_frame is not None:
                self._subscribe_to_stations(robot, receive_frame)
            self._offer_services(robot, named)
        node.declare_param(names.USE_SIM_TIME, True)
        node.declare_param(CALLER, sendable(description.rest))
        self._parameters = LiveParameters(
            self._node, team.parameters, description.body, self._limiter, self._ask, description.external
        )
        if self._external.amcl:
            self._declare_starts()
        offer_loggers(self._node)

    def _declare_starts(self) -> None:
        """Set each robot's start pose as parameters for an external amcl. Our localizer starts at the same pose."""
        for robot, named in enumerate(self._robots):
            pose = self._team.believed_pose(robot)
            for name, value in (("x", pose.x), ("y", pose.y), ("a", pose.theta)):
                self._node.ros.declare_param(named.topic(f"amcl/initial_pose_{name}"), value)

    async def start(self) -> NodeStarted | CannotListen:
        """Join the graph, whose master may start later."""
        return await self._node.ros.start()

    async def stop(self) -> None:
        """Leave the graph."""
        await self._node.ros.stop()

    def _on_shutdown(self, reason: str) -> None:
        # Nodes of the graph must not end the participant's hunt, so only the connection to the graph is closed.
        _log.warning("disconnected from the ROS graph (%s); the session continues without it", reason)
        self._node.ros.leave()

    @property
    def dropped(self) -> int:
        """Number of messages that slow subscribers did not get."""
        return sum(publication.dropped for publication in self._publications.values())

    def take(self, tick: int, messages: Iterable[RosMessage]) -> None:
        """Publish the messages of one tick; the clock is the first message."""
        self._tick = tick
        self._requests.advance(tick)
        self._parameters.follow(self._team.parameters)
        self._publications[CLOCK.name].publish(pack.clock(tick))
        for message in messages:
            publication = None if message.foreign else self._publications.get(message.topic.name)
            if publication is not None:
                data = message.data
                if self._external.amcl and message.topic.name == names.TF:
                    data = without_corrections(data)
                publication.publish(data)
            current = self._current_goals.get(message.topic.name)
            if current is not None:
                goal = clients.action_goal(message.data)
                if isinstance(goal, clients.ActionGoal) and isinstance(goal.pose, Pose2):
                    current.publish(pack.pose_stamped(tick, MAP_FRAME, goal.pose))
        self._publish_recoveries()

    def _is_external(self, topic: str) -> bool:
        """Return True for a topic of a node that another program runs."""
        words = {word for named in self._robots if (word := topic.removeprefix(f"{named.namespace}/")) != topic}
        word = next(iter(words), "")
        if self._external.move_base and (word.startswith("move_base") or word == "cmd_vel"):
            return True
        return self._external.amcl and word in OF_AMCL

    def _publish_recoveries(self) -> None:
        """Publish all recovery behaviors that robots have begun in the last tick."""
        if self._external.move_base:
            return
        for robot, (progress, begun) in enumerate(zip(self._team.recoveries, self._recoveries.take(), strict=True)):
            for number in begun:
                name, base = progress.names[number], self._team.believed_pose(robot)
                status = pack.recovery_status(self._tick, MAP_FRAME, base, number, len(progress.names), name)
                self._recovery_status[robot].publish(status)

    # Messages of clients

    def _subscribe_to_clients(self, robot: int, named: RobotNames) -> None:
        for topic in CLIENT_TOPICS:
            if not self._external.has(topic.external):
                read = partial(self._requests.read, topic, robot)
                self._receive(named.topic(topic.name), topic.msgtype, read, self._ask)

    def _subscribe_to_stations(self, robot: int, receive: Callable[[int, Frame], None]) -> None:
        topic = VehicleTopics(self._robots[robot]).received
        self._receive(
            topic.name,
            topic.msgtype,
            lambda data: frame_in(unpack.mavlink(data)),
            lambda client, frame: receive(robot, frame),
        )

    def _receive(self, topic: str, msgtype: str, read: Callable[[bytes], R], take: Callable[[str, R], None]) -> None:
        """Subscribe to a topic of clients; see `ClientRequests.receive`."""

        def on_message(data: bytes, caller: str) -> None:
            if caller != CALLER:  # The game sends its own goals and commands on the same topics.
                self._requests.receive(topic, caller, data, read, take)

        self._node.subscribe(topic, msgtype, on_message)

    # Services

    def _offer_map(self) -> None:
        whole = pack.occupancy_grid(0, MAP_FRAME, self._description.grid)
        self._node.serve(names.STATIC_MAP, types.GET_MAP, lambda request: whole)

    def _offer_services(self, robot: int, named: RobotNames) -> None:
        for external, service, request in (
            ("amcl", "global_localization", GlobalLocalization(robot)),
            ("amcl", "request_nomotion_update", NomotionUpdate(robot)),
            ("move_base", "move_base/clear_costmaps", ClearCostmaps(robot)),
        ):
            if not self._external.has(external):
                name = named.topic(service)
                self._node.serve(name, types.EMPTY, partial(self._pass_on, name, request))
        if self._external.amcl:
            return
        self._node.serve(named.topic("set_map"), types.SET_MAP, partial(self._set_map, robot))
        self._node.serve(named.topic("set_pose"), types.SET_POSE, partial(self._set_pose, robot))
        for plan in () if self._external.move_base else ("move_base/make_plan", "move_base/NavfnROS/make_plan"):
            self._node.serve(named.topic(plan), types.GET_PLAN, self._turns.wrap(partial(self._make_plan, robot)))

    def _pass_on(self, service: str, request: Request, data: bytes) -> bytes:
        if self._limiter.is_first(service):
            self._ask(service, request)
        return b""

    def _set_pose(self, robot: int, data: bytes) -> bytes | ServiceFailed:
        service = self._robots[robot].topic("set_pose")
        if not self._limiter.admits(service, "clients"):
            return ServiceFailed("too many requests")
        found = clients.pose_estimate(data)
        if isinstance(found, InvalidMessage):
            return ServiceFailed(found.sentence)
        self._ask(service, SetPoseEstimate(robot, found.base_in_map, found.covariance))
        return b""

    def _set_map(self, robot: int, data: bytes) -> bytes | ServiceFailed:
        """Answer amcl's service set_map. Only the pose has an effect, because all robots must have the same map."""
        service = self._robots[robot].topic("set_map")
        if not self._limiter.admits(service, "clients"):
            return ServiceFailed("too many requests")
        found = clients.map_request(data)
        if isinstance(found, InvalidMessage):
            return ServiceFailed(found.sentence)
        if found.grid != self._description.grid:
            self._complaints.warn(f"{service}: the map cannot be replaced during a session")
            return pack.boolean(False)
        self._ask(service, SetPoseEstimate(robot, found.estimate.base_in_map, found.estimate.covariance))
        return pack.boolean(True)

    def _make_plan(self, robot: int, data: bytes) -> bytes | ServiceFailed:
        question = clients.plan_request(data)
        if isinstance(question, InvalidMessage):
            return ServiceFailed(question.sentence)
        plan = self._team.make_plan(robot, question.start, question.goal, question.tolerance)
        if isinstance(plan, NoPlan):
            # Like move_base, answer with an empty plan, and only log the reason.
            _log.info("%s: no plan: %s", self._robots[robot].topic("move_base/make_plan"), plan.sentence)
            return pack.path(self._tick, MAP_FRAME, NO_POSES)
        return pack.path(self._tick, MAP_FRAME, plan)


@asynccontextmanager
async def on_graph(
    live: LiveGraph, graph: GraphAddress, joined: Callable[[MasterPresence | CannotListen], None]
) -> AsyncIterator[None]:
    """Join the graph, and leave it at the end of the context.

    Args:
        live: the session's node.
        graph: the ROS graph.
        joined: callback with the master, or with the reason why there is no master or the node cannot listen. The
            callback may raise an exception.
    """
    async with ensure_master(graph) as master:
        joined(master)
        where = await live.start()
        if isinstance(where, CannotListen):
            joined(where)
        try:
            yield
        finally:
            await live.stop()
