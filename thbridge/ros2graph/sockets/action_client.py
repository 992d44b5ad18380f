"""Client of an action of a ROS 2 graph: clients of its three services, and subscriptions to its two topics."""

import logging
from collections.abc import Callable
from typing import TypeAlias, cast

from thbridge.ros2.action_messages import goal_info, goal_info_of, goal_state, goal_statuses, nanoseconds, uuid_of
from thbridge.ros2.actions import ActionGoalStatus, ActionResult, CancelAnswer, CancelCode, GoalInfo
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.message_fields import (
    CancelResponseFields,
    FeedbackMessageFields,
    GetResultResponseFields,
    GoalStatusArrayFields,
    SendGoalResponseFields,
)
from thbridge.ros2.qos import DEFAULT, LATCHED
from thbridge.ros2.supports import ServiceSupport
from thbridge.ros2graph.sockets.carrier import GraphCarrier, GraphClient
from thbridge.ros2graph.values.graph import NodeName
from thbridge.sockets.warn_once import WarnOnce

_log = logging.getLogger(__name__)

OnAnswer: TypeAlias = Callable[[int | None], None]
"""Callback with the time at which the server accepted a goal, nanoseconds. None if it rejected the goal."""


class GraphActionClient:
    """Action client on a carrier.

    Args:
        carrier: connection to the graph.
        node: node that has the client.
        name: full name of the action, for example "/robot1/navigate_to_pose".
        distribution: message types.
        action: type of the action.
        on_feedback: callback with the id of a goal and its feedback.
        on_status: callback with the status list.
    """

    def __init__(
        self,
        carrier: GraphCarrier,
        node: NodeName,
        name: str,
        distribution: Distribution,
        action: str,
        on_feedback: Callable[[bytes, object], None] = lambda goal_id, feedback: None,
        on_status: Callable[[tuple[ActionGoalStatus, ...]], None] = lambda statuses: None,
    ) -> None:
        self._name = name
        self._distribution = distribution
        self._types = types = distribution.action(action)
        self._on_feedback = on_feedback
        self._on_status = on_status
        self._complaints = WarnOnce(_log)
        self._send_goal = carrier.client(node, f"{name}/_action/send_goal", types.send_goal)
        self._cancel_goal = carrier.client(node, f"{name}/_action/cancel_goal", types.cancel_goal)
        self._get_result = carrier.client(node, f"{name}/_action/get_result", types.get_result)
        carrier.subscribe(node, f"{name}/_action/feedback", types.feedback, DEFAULT, self._receive_feedback)
        carrier.subscribe(node, f"{name}/_action/status", types.status, LATCHED, self._receive_status)

    @property
    def has_server(self) -> bool:
        """True if a server of all three services is known."""
        return self._send_goal.has_server and self._cancel_goal.has_server and self._get_result.has_server

    def send_goal(self, goal_id: bytes, goal: object, on_answer: OnAnswer) -> None:
        """Send a goal. The id must be new."""

        def answered(response: object) -> None:
            fields = cast(SendGoalResponseFields, response)
            on_answer(nanoseconds(fields.stamp) if fields.accepted else None)

        goal_uuid = uuid_of(self._distribution, goal_id)
        self._call(self._send_goal, self._types.send_goal, answered, goal_id=goal_uuid, goal=goal)

    def get_result(self, goal_id: bytes, on_result: Callable[[ActionResult[object]], None]) -> None:
        """Wait for the result of a goal."""

        def answered(response: object) -> None:
            fields = cast(GetResultResponseFields, response)
            on_result(ActionResult(goal_state(fields.status), fields.result))

        self._call(self._get_result, self._types.get_result, answered, goal_id=uuid_of(self._distribution, goal_id))

    def cancel(self, goal: GoalInfo, on_answer: Callable[[CancelAnswer], None] = lambda answer: None) -> None:
        """Cancel goals; see `ActionGoals.cancel`."""

        def answered(response: object) -> None:
            fields = cast(CancelResponseFields, response)
            code = CancelCode(fields.return_code) if fields.return_code in {*CancelCode} else CancelCode.REJECTED
            on_answer(CancelAnswer(code, tuple(goal_info(each) for each in fields.goals_canceling)))

        info = goal_info_of(self._distribution, goal)
        self._call(self._cancel_goal, self._types.cancel_goal, answered, goal_info=info)

    def close(self) -> None:
        """Leave the graph. No further response is delivered."""
        for client in (self._send_goal, self._cancel_goal, self._get_result):
            client.close()

    def _call(
        self, client: GraphClient, service: ServiceSupport, on_response: Callable[[object], None], **fields: object
    ) -> None:
        def decoded(data: bytes) -> None:
            if (response := self._decoded(service.response.name, data)) is not None:
                on_response(response)

        client.call(self._distribution.encoded(service.request.name, **fields), decoded)

    def _receive_feedback(self, data: bytes, publisher: bytes) -> None:
        message = cast(FeedbackMessageFields | None, self._decoded(self._types.feedback.name, data))
        if message is not None:
            self._on_feedback(message.goal_id.uuid.tobytes(), message.feedback)

    def _receive_status(self, data: bytes, publisher: bytes) -> None:
        message = cast(GoalStatusArrayFields | None, self._decoded(self._types.status.name, data))
        if message is not None:
            self._on_status(goal_statuses(message))

    def _decoded(self, name: str, data: bytes) -> object | None:
        try:
            return self._distribution.decode(name, data)
        except ValueError as error:
            self._complaints.warn(f"{self._name}: ignoring a message: {error}")
            return None
