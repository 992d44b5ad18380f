"""Fleet of real robots on a ROS graph, which is used as a team. It adds sockets to `RemoteTeam`."""

import asyncio
import logging
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Protocol

from sim.common.robot_numbers import robot_name
from thbridge.files.ros.definitions import ROS_SHARES, Definitions
from thbridge.ros import names
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import types
from thbridge.ros.messages.cursor import Cursor
from thbridge.ros.reconfigure import DescribedParameter
from thbridge.ros.remote.clock import RosClock
from thbridge.ros.remote.robot import RemoteRobot
from thbridge.ros.remote.team import RemoteTeam
from thbridge.ros.topics import RosMessage
from thbridge.rosgraph.sockets.fleet_parameters import FleetParameters
from thbridge.rosgraph.sockets.joining import GraphAddress
from thbridge.rosgraph.sockets.node import NodeStarted, RosNode
from thbridge.rosgraph.sockets.publications import Publication
from thbridge.rosgraph.wire import links
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.warn_once import WarnOnce

TEAM_TOPICS = (names.TF, names.TF_STATIC, names.MAP, names.MAP_METADATA, names.ROSOUT, names.DIAGNOSTICS)
"""Recorded topics that do not belong to a single robot."""
_log = logging.getLogger(__name__)


class TrafficRecorder(Protocol):
    """Recorder of messages from and to the robots. It must not raise exceptions."""

    def received(self, topic: links.TopicHeader, publisher: str, stamp_ns: int, data: bytes) -> None:
        """Record a received message with its original bytes at this ROS time."""

    def sent(self, message: RosMessage) -> None:
        """Record a message sent to a robot."""


class Fleet(RemoteTeam):
    """Team of real robots on a ROS 1 graph.

    Args:
        graph: address of their ROS graph.
        robots: state and messages of each robot.
        recorder: recorder of all messages.
        offset: time by which odometry is ahead of the scans. Its default is the value at the start.
        wall: returns the time of the wall clock, nanoseconds.
    """

    def __init__(
        self,
        graph: GraphAddress,
        robots: Sequence[RemoteRobot],
        recorder: TrafficRecorder,
        offset: DescribedParameter,
        wall: Callable[[], int] = time.time_ns,
    ) -> None:
        self._node = RosNode(
            names.FLEET, graph.master_uri, graph.host, on_shutdown=self._asked_to_leave, admission=graph.admission
        )
        super().__init__(robots, offset, wall)
        self._recorder = recorder
        self._definitions = Definitions(ROS_SHARES)
        self._publications: dict[str, Publication] = {
            topic.name: self._advertise(topic.name, topic.msgtype)
            for robot in self.robots
            for topic in robot.publications
        }
        FleetParameters(self._node, self._definitions, offset, self.correct_odometry)
        self._headers: dict[tuple[str, str], links.TopicHeader] = {}
        self._joining: asyncio.Task[None] | None = None
        self._complaints = WarnOnce(_log)

    async def start(self) -> NodeStarted | CannotListen:
        """Join the graph. Master and robots may appear later."""
        started = await self._node.start()
        if isinstance(started, NodeStarted):
            self._joining = asyncio.get_running_loop().create_task(self._join())
        return started

    async def stop(self) -> None:
        """Stop the robots, and leave the graph."""
        if self._joining is not None:
            self._joining.cancel()
            await asyncio.wait([self._joining])
        self._stop_robots()
        await self._node.stop()

    def missing(self) -> list[str]:
        """Return the reasons why the robots cannot be commanded yet. Each reason is one sentence."""
        if self.clock is None:
            return [f"there is no ROS master at {self._node.master_uri} yet"]
        if not self.clock.runs:
            return [f"{names.USE_SIM_TIME} is set, but there is no time on {names.CLOCK} yet"]
        return super().missing() or list(self._not_subscribed())

    def _not_subscribed(self) -> Iterator[str]:
        """Yield a sentence for each robot that does not subscribe to its goals yet."""
        for robot, remote in enumerate(self.robots):
            goal = remote.names.action("goal")
            if all(connection.peer == names.FLEET for connection in self._publications[goal].connections()):
                yield (
                    f"{robot_name(robot)} does not subscribe to {goal} yet: its machine must be able to reach this one "
                    f"at {self._node.host} (--ros-host)"
                )

    # The graph

    async def _join(self) -> None:
        """Wait for the master, select wall time or simulated time, and subscribe."""
        await self._node.registered()
        # As for all ROS nodes, this parameter selects between the wall clock and the topic /clock.
        simulated = await self._node.get_param(names.USE_SIM_TIME) is True
        clock = RosClock(simulated)
        self.clock = clock
        if simulated:
            self._follow_time(clock)
            while not clock.runs:
                await asyncio.sleep(0.05)
        wanted: dict[str, list[RemoteRobot]] = {topic: [] for topic in TEAM_TOPICS}
        for robot in self.robots:
            named = robot.names
            for topic in (*named.recorded, named.action("feedback"), named.action("cancel"), named.initialpose):
                wanted.setdefault(topic, [])
            for topic in robot.subscriptions:
                wanted.setdefault(topic, []).append(robot)
        wanted.pop(names.CLOCK, None)  # It is not recorded, because the player of a bag publishes its own clock.
        for topic, robots in wanted.items():
            self._listen(topic, {robot: robot.subscriptions[topic] for robot in robots})

    def _follow_time(self, clock: RosClock) -> None:
        def on_message(data: bytes, publisher: str) -> None:
            try:
                clock.receive(Cursor(data).stamp(), self._wall())
            except ValueError as error:
                self._complaints.warn(f"{names.CLOCK}: a message of {publisher} is ignored: {error}")

        self._node.subscribe(names.CLOCK, types.CLOCK, self._definitions.of(types.CLOCK).md5, on_message)

    def _listen(self, topic: str, robots: Mapping[RemoteRobot, str]) -> None:
        wanted = {robot: self._definitions.of(kind).md5 for robot, kind in robots.items()}

        def on_publisher(publisher: str, header: links.TopicHeader) -> None:
            self._headers[topic, publisher] = header
            if header.md5 not in wanted.values() and wanted:
                kind = next(iter(robots.values()))
                self._complaints.warn(f"{topic}: {publisher} publishes {header.type}, but {kind} was expected")

        def on_message(data: bytes, publisher: str) -> None:
            # Messages of this program are recorded when they are sent.
            now_ns = self.now()
            if publisher == names.FLEET or now_ns is None:
                return
            header = self._headers[topic, publisher]
            self._recorder.received(header, publisher, now_ns, data)
            for robot, md5 in wanted.items():
                if header.md5 == md5 and isinstance(refused := robot.receive(topic, data, now_ns), InvalidMessage):
                    self._complaints.warn(f"{topic}: a message of {publisher} is ignored: {refused.sentence}")

        # Any type is accepted, because the recorder stores messages with their publishers' own types.
        self._node.subscribe(topic, "*", "*", on_message, on_publisher=on_publisher)

    def _advertise(self, topic: str, msgtype: str) -> Publication:
        definition = self._definitions.of(msgtype)
        return self._node.advertise(topic, msgtype, definition.md5, definition.text)

    def _send(self, robot: int, message: RosMessage) -> None:
        self._publications[message.topic.name].publish(message.data)

    def _record(self, message: RosMessage) -> None:
        self._recorder.sent(message)

    def _asked_to_leave(self, reason: str) -> None:
        _log.error("the robots cannot be reached: this program must leave the ROS graph (%s)", reason)
        self._node.leave()
