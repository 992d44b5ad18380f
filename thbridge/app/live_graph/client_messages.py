"""Conversion of messages of ROS clients into requests to robots, and the topics of these messages."""

import logging
from collections.abc import Callable
from itertools import count
from typing import NamedTuple, TypeVar

from thbridge.app.live_graph.rate_limiter import RateLimiter
from thbridge.roles.shared.robot_requests import Request
from thbridge.ros import clients
from thbridge.ros.clients import InvalidMessage
from thbridge.ros.messages import types
from thbridge.ros.messages.records import CancelRequest, GoalRequest, InitialPose, SimpleGoal, VelocityCommand
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.sockets.warn_once import WarnOnce

R = TypeVar("R")

_log = logging.getLogger(__name__)


class ClientMessages:
    """Reader of clients' messages, which gives numbers to goals in the order of reading.

    Attributes:
        numbers: numbers of the next goals.
    """

    def __init__(self) -> None:
        self.numbers = count()
        self._tick = 0

    def advance(self, tick: int) -> None:
        """Store the number of the present tick."""
        self._tick = tick

    def pose(self, robot: int, data: bytes) -> Request | InvalidMessage:
        """Return the request in a message on the topic `initialpose`."""
        found = clients.pose_estimate(data)
        return found if isinstance(found, InvalidMessage) else InitialPose(robot, found.base_in_map, found.covariance)

    def velocity(self, robot: int, data: bytes) -> Request | InvalidMessage:
        """Return the request in a message on the topic `cmd_vel`."""
        found = clients.velocity(data)
        return found if isinstance(found, InvalidMessage) else VelocityCommand(robot, found)

    def simple_goal(self, robot: int, data: bytes) -> Request | InvalidMessage:
        """Return the request in a message on the topic `move_base_simple/goal`."""
        found = clients.goal_pose(data)
        return found if isinstance(found, InvalidMessage) else SimpleGoal(robot, found, next(self.numbers))

    def goal(self, robot: int, data: bytes) -> Request | InvalidMessage:
        """Return the request in a message on the topic `move_base/goal`."""
        found = clients.action_goal(data)
        if isinstance(found, InvalidMessage):
            return found
        number, stamp = next(self.numbers), self._not_ahead(found.stamp_ns)
        if isinstance(found.pose, InvalidMessage):
            # A goal without a valid pose is also passed on, because the client waits for a result.
            return GoalRequest(robot, found.goal_id, stamp, None, number, found.pose.sentence)
        return GoalRequest(robot, found.goal_id, stamp, found.pose, number)

    def cancel(self, robot: int, data: bytes) -> Request | InvalidMessage:
        """Return the request in a message on the topic `move_base/cancel`."""
        found = clients.action_cancel(data)
        if isinstance(found, InvalidMessage):
            return found
        return CancelRequest(robot, found.goal_id, self._not_ahead(found.stamp_ns))

    def _not_ahead(self, stamp: int) -> int:
        """Return a client's stamp; if the stamp is in the future, return the present time.

        Stamps are in the future if a client does not use /use_sim_time. The goal with the newest stamp has priority, so
        a stamp in the future would block all other clients until that time.
        """
        return min(stamp, stamp_ns(self._tick))


class ClientTopic(NamedTuple):
    """Topic of a robot with messages of clients.

    Attributes:
        name: its name on ROS 1 graphs.
        msgtype: its type there.
        read: reader of its messages.
        external: external node that reads it instead of the session. Empty if there is none.
        ros2: its name on ROS 2 graphs, and Nav2's node that reads it. None if an action of ROS 2 replaces it.
    """

    name: str
    msgtype: str
    read: Callable[[ClientMessages, int, bytes], Request | InvalidMessage]
    external: str
    ros2: tuple[str, str] | None


_MOVE_BASE, _NAVIGATOR = "move_base", ("goal_pose", "bt_navigator")
CLIENT_TOPICS = (
    ClientTopic("initialpose", types.POSE_WITH_COVARIANCE, ClientMessages.pose, "amcl", ("initialpose", "amcl")),
    ClientTopic("cmd_vel", types.TWIST, ClientMessages.velocity, "", ("cmd_vel", "")),
    ClientTopic("move_base_simple/goal", types.POSE_STAMPED, ClientMessages.simple_goal, _MOVE_BASE, _NAVIGATOR),
    ClientTopic("move_base/goal", types.MOVE_BASE_GOAL, ClientMessages.goal, _MOVE_BASE, None),
    ClientTopic("move_base/cancel", types.GOAL_ID, ClientMessages.cancel, _MOVE_BASE, None),
)


class ClientRequests:
    """Requests of all clients of a session, on ROS 1 and ROS 2 graphs. Their rate is limited.

    Args:
        ask: callback with the name of a client and its request.

    Attributes:
        messages: reader of their messages.
        limiter: limiter of their rate.
    """

    def __init__(self, ask: Callable[[str, Request], None]) -> None:
        self.messages = ClientMessages()
        self.limiter = RateLimiter()
        self.ask = ask
        self._complaints = WarnOnce(_log)

    def advance(self, tick: int) -> None:
        """Store the number of the present tick. The session has processed the requests so far."""
        self.messages.advance(tick)
        self.limiter.tick()

    def read(self, topic: ClientTopic, robot: int, data: bytes) -> Request:
        """Return the request in a message. Raises ValueError: it is invalid."""
        found = topic.read(self.messages, robot, data)
        if isinstance(found, InvalidMessage):
            raise ValueError(found.sentence)
        return found

    def receive(
        self, topic: str, client: str, data: bytes, read: Callable[[bytes], R], take: Callable[[str, R], None]
    ) -> None:
        """Pass on the content of a message, with the name of the client. Log invalid messages once.

        Args:
            topic: topic of the message.
            client: node of its publisher.
            data: the message.
            read: reader of messages. For invalid messages, it raises ValueError.
            take: callback for the content.
        """
        if not self.limiter.admits(topic, client):
            return
        try:
            content = read(data)
        except ValueError as error:
            self._complaints.warn(f"{topic}: ignoring a message of {client}: {error}")
        else:
            take(client, content)
