"""Action server of a ROS 2 node: its three services and two topics."""

import logging
from collections.abc import Callable
from typing import cast

from thbridge.ros2.action_logic import ActionLogic
from thbridge.ros2.action_messages import encode_statuses, goal_info, goal_info_of, time_of, uuid_of
from thbridge.ros2.actions import ActionResult, CancelAnswer, CancelCode
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.message_fields import CancelRequestFields, GetResultRequestFields, SendGoalRequestFields
from thbridge.ros2.qos import DEFAULT, LATCHED
from thbridge.ros2.supports import ServiceSupport
from thbridge.ros2graph.sockets.carrier import GraphCarrier, Reply
from thbridge.ros2graph.values.graph import NodeName
from thbridge.sockets.warn_once import WarnOnce

_log = logging.getLogger(__name__)


class GraphActionServer:
    """Action server on a carrier. Its logic decides about goals.

    Args:
        carrier: connection to the graph.
        node: node that has the server.
        name: full name of the action, for example "/robot1/navigate_to_pose".
        distribution: message types.
        action: type of the action.
        logic: logic of the server.
        admit: returns False if a client's node sends too many requests to a service. These requests are rejected.
    """

    def __init__(
        self,
        carrier: GraphCarrier,
        node: NodeName,
        name: str,
        distribution: Distribution,
        action: str,
        logic: ActionLogic,
        admit: Callable[[str, str], bool] = lambda service, client: True,
    ) -> None:
        self._carrier = carrier
        self._name = name
        self._distribution = distribution
        self._types = types = distribution.action(action)
        self._logic = logic
        self._admit = admit
        self._complaints = WarnOnce(_log)
        self._empty_result = distribution.make(f"{action}_Result")
        carrier.serve(node, f"{name}/_action/send_goal", types.send_goal, self._receive_goal)
        carrier.serve(node, f"{name}/_action/cancel_goal", types.cancel_goal, self._receive_cancel)
        carrier.serve(node, f"{name}/_action/get_result", types.get_result, self._receive_result_request)
        self._feedback = carrier.publish(node, f"{name}/_action/feedback", types.feedback, DEFAULT)
        self._status = carrier.publish(node, f"{name}/_action/status", types.status, LATCHED)
        logic.has_listeners = lambda: self._feedback.readers > 0

    def publish(self) -> None:
        """Publish new feedback, and the status list if a goal has changed. Call this after each tick.

        The list is not published with each request, because it has all goals, and clients may send many requests.
        """
        for goal_id, feedback in self._logic.take_feedback():
            goal_uuid = uuid_of(self._distribution, goal_id)
            name = self._types.feedback.name
            self._feedback.write(self._distribution.encoded(name, goal_id=goal_uuid, feedback=feedback))
        goals = self._logic.goals
        if goals.changed:
            goals.changed = False
            self._status.write(encode_statuses(goals.statuses))

    # Services

    def _receive_goal(self, data: bytes, gid: bytes, reply: Reply) -> None:
        service, client = self._types.send_goal, self._carrier.node_of(gid)
        request = cast(SendGoalRequestFields | None, self._decoded(service.request.name, data, client))
        if request is None:
            return
        accepted: int | None = None
        if self._admit(f"{self._name}/_action/send_goal", client):
            accepted = self._logic.receive_goal(request.goal_id.uuid.tobytes(), request.goal, client)
        stamp = time_of(self._distribution, accepted or 0)
        self._respond(reply, service, accepted=accepted is not None, stamp=stamp)

    def _receive_cancel(self, data: bytes, gid: bytes, reply: Reply) -> None:
        service, client = self._types.cancel_goal, self._carrier.node_of(gid)
        request = cast(CancelRequestFields | None, self._decoded(service.request.name, data, client))
        if request is None:
            return
        answer = CancelAnswer(CancelCode.REJECTED)
        if self._admit(f"{self._name}/_action/cancel_goal", client):
            answer = self._logic.receive_cancel(*goal_info(request.goal_info), client)
        goals = [goal_info_of(self._distribution, goal) for goal in answer.goals]
        self._respond(reply, service, return_code=int(answer.code), goals_canceling=goals)

    def _receive_result_request(self, data: bytes, gid: bytes, reply: Reply) -> None:
        service, client = self._types.get_result, self._carrier.node_of(gid)
        request = cast(GetResultRequestFields | None, self._decoded(service.request.name, data, client))
        if request is None:
            return

        def send(result: ActionResult[object]) -> None:
            value = self._empty_result if result.value is None else result.value
            self._respond(reply, service, status=int(result.state), result=value)

        self._logic.goals.ask_result(request.goal_id.uuid.tobytes(), send)

    def _decoded(self, name: str, data: bytes, client: str) -> object | None:
        """Return a decoded request, or None if it is not a message."""
        try:
            return self._distribution.decode(name, data)
        except ValueError as error:
            self._complaints.warn(f"{self._name}: ignoring a request of {client}: {error}")
            return None

    def _respond(self, reply: Reply, service: ServiceSupport, **fields: object) -> None:
        reply(self._distribution.encoded(service.response.name, **fields))
