"""Action navigate_to_pose of a real Nav2 robot, in the form of the action move_base of ROS 1.

Goals and cancel requests for move_base become requests of the action. Its answers, status lists and results become
messages of move_base. So a robot of ROS 2 is commanded, supervised and recorded as a robot of ROS 1.

The status list of ROS 2 is published only after a change, but that of ROS 1 at least 5 times per second. So this class
repeats the list while the server is on the graph and, during a drive, sends feedback.
"""

import hashlib
from dataclasses import dataclass
from typing import cast

from sim.common.geometry import Pose2
from thbridge.ros.messages import pack, unpack
from thbridge.ros.messages.cursor import Cursor
from thbridge.ros.messages.goal_status import ENDED, GoalId, GoalStatus, GoalStatusCode
from thbridge.ros.messages.stamps import tick_of
from thbridge.ros.remote.goals import NAV2_ERROR
from thbridge.ros.remote.names import RemoteNames
from thbridge.ros.topics import RosMessage
from thbridge.ros2.actions import ActionGoalState, ActionGoalStatus, ActionResult, GoalInfo
from thbridge.ros2.message_fields import NavigationResultFields

STATUS_PERIOD_NS = 200_000_000
"""Time between two status lists for ROS 1."""
FEEDBACK_GAP_NS = 1_000_000_000
"""After this time without feedback during a drive, the status list is not repeated. Nav2 sends it 100 times per
second."""
LEASE_NS = 30_000_000_000
"""After this time, DDS knows whether a program still runs. So a server on the graph is alive, even without feedback."""
RESULT_WAIT_NS = 1_000_000_000
"""Time after the end of a goal in the status list for which its result is awaited. The result has the reason."""

_STATUS = {
    ActionGoalState.UNKNOWN: GoalStatusCode.LOST,
    ActionGoalState.ACCEPTED: GoalStatusCode.PENDING,
    ActionGoalState.EXECUTING: GoalStatusCode.ACTIVE,
    ActionGoalState.CANCELING: GoalStatusCode.PREEMPTING,
    ActionGoalState.SUCCEEDED: GoalStatusCode.SUCCEEDED,
    ActionGoalState.CANCELED: GoalStatusCode.PREEMPTED,
    ActionGoalState.ABORTED: GoalStatusCode.ABORTED,
}


@dataclass(frozen=True, slots=True)
class Nav2Goal:
    """Goal that must be sent to the robot."""

    goal_id: bytes
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class Nav2Cancel:
    """Goal that must be canceled."""

    goal_id: bytes


@dataclass(slots=True, eq=False)
class _SentGoal:
    """Our newest goal.

    Attributes:
        goal_id: its UUID.
        text: its id in ROS 1.
        feedback_ns: time of its newest feedback. None before the first.
        ended_ns: time at which the status list first showed its end. None before.
        doubt: text of a result without an error code, which may mean that another goal preempts it. Otherwise empty.
        final: its status after its result has arrived.
    """

    goal_id: bytes
    text: str
    feedback_ns: int | None = None
    ended_ns: int | None = None
    doubt: str = ""
    final: GoalStatus | None = None


class Nav2Goals:
    """Goals of one robot.

    Args:
        named: names of the robot. Its messages of move_base have these names.
        prefix: common prefix of the ids of all our goals for this robot, in ROS 1. It is the same in every run.
    """

    def __init__(self, named: RemoteNames, prefix: str) -> None:
        self._goal, self._cancel = named.action("goal"), named.action("cancel")
        self._prefix = prefix
        self._own = hashlib.sha256(prefix.encode()).digest()[:8]
        self._statuses: tuple[ActionGoalStatus, ...] = ()
        self._sent: _SentGoal | None = None
        self._published_ns = 0
        self._changed = False
        self._results: list[GoalStatus] = []

    def request_of(self, message: RosMessage) -> Nav2Goal | Nav2Cancel | None:
        """Return the request for a message to move_base. Return None for other messages."""
        if message.topic.name == self._goal:
            goal = unpack.move_base_goal(message.data)
            # The first half of the id marks it as ours, also in later runs. The second half is the time.
            goal_id = self._own + Cursor.behind_header(message.data).stamp().to_bytes(8, "big")
            self._sent = _SentGoal(goal_id, goal.goal_id)
            return Nav2Goal(goal_id, goal.pose)
        if message.topic.name == self._cancel:
            return Nav2Cancel(self._id_of(unpack.goal_id(message.data).id))
        return None

    # Messages of the server

    def receive_answer(self, goal_id: bytes, *, accepted: bool) -> None:
        """Process the answer to a goal."""
        sent = self._sent
        if sent is None or sent.goal_id != goal_id:
            return
        if not accepted:
            self._end(sent, GoalStatusCode.REJECTED, "navigate_to_pose rejected the goal")
        elif all(status.goal.id != goal_id for status in self._statuses):
            # The answer may arrive before the status list.
            self._statuses = (*self._statuses, ActionGoalStatus(GoalInfo(goal_id, 0), ActionGoalState.ACCEPTED))
            self._changed = True

    def receive_statuses(self, statuses: tuple[ActionGoalStatus, ...], now_ns: int) -> None:
        """Process a status list."""
        self._statuses, self._changed = statuses, True
        sent = self._sent
        if sent is None or sent.ended_ns is not None:
            return
        if any(goal.id == sent.goal_id and _STATUS[state] in ENDED for goal, state in statuses):
            sent.ended_ns = now_ns

    def receive_feedback(self, goal_id: bytes, now_ns: int) -> None:
        """Process feedback of a goal. Only its time of arrival counts."""
        if self._sent is not None and self._sent.goal_id == goal_id:
            self._sent.feedback_ns = now_ns

    def receive_result(self, goal_id: bytes, result: ActionResult[object], now_ns: int) -> None:
        """Process the result of our goal."""
        sent = self._sent
        if sent is None or sent.goal_id != goal_id or _STATUS[result.state] not in ENDED:
            return
        status, text = _STATUS[result.state], ""
        if result.state is ActionGoalState.UNKNOWN:
            return  # The server forgot the goal. The status list shows this, too.
        if result.state is ActionGoalState.ABORTED:
            fields = cast(NavigationResultFields, result.value)
            text = f"{fields.error_msg or 'no reason given'} ({NAV2_ERROR} {fields.error_code})"
            if fields.error_code == 0:
                # Nav2 aborts a goal without an error if another goal preempts it. `step` waits for that goal.
                sent.ended_ns, sent.doubt = sent.ended_ns or now_ns, text
                return
        self._end(sent, status, text)

    def step(self, now_ns: int, *, has_server: bool) -> list[tuple[str, bytes]]:
        """Return the messages of move_base that are due: the part of the action, and the bytes.

        Args:
            now_ns: the time.
            has_server: True if the action server is on the graph.
        """
        self._decide(now_ns)
        tick = tick_of(now_ns)
        messages = [("result", pack.move_base_result(tick, entry)) for entry in self._results]
        self._results = []
        if not has_server:
            # After a restart, the server does not know the earlier goals.
            self._statuses, self._sent = (), None
            return messages
        due = self._changed or now_ns - self._published_ns >= STATUS_PERIOD_NS
        if due and not self._is_mute(now_ns):
            self._changed, self._published_ns = False, now_ns
            entries = [self._entry(status, now_ns) for status in self._statuses]
            messages.append(("status", pack.goal_status_array(tick, entries)))
        return messages

    def _decide(self, now_ns: int) -> None:
        """End a goal that was aborted without an error. It was preempted if another goal is active."""
        sent = self._sent
        if sent is None or not sent.doubt or sent.final is not None:
            return
        if any(goal.id != sent.goal_id and _STATUS[state] not in ENDED for goal, state in self._statuses):
            self._end(sent, GoalStatusCode.PREEMPTED, "")
        elif now_ns - (sent.ended_ns or 0) >= RESULT_WAIT_NS:
            self._end(sent, GoalStatusCode.ABORTED, sent.doubt)

    def _is_mute(self, now_ns: int) -> bool:
        """Return True if the robot drives to our goal, but feedback no longer arrives."""
        sent = self._sent
        if sent is None or sent.feedback_ns is None or sent.final is not None or sent.ended_ns is not None:
            return False
        return FEEDBACK_GAP_NS < now_ns - sent.feedback_ns <= LEASE_NS

    def _entry(self, status: ActionGoalStatus, now_ns: int) -> GoalStatus:
        goal, state = status
        sent = self._sent
        code = _STATUS[state]
        if sent is not None and sent.goal_id == goal.id:
            if sent.final is not None:
                return sent.final
            waits = sent.ended_ns is not None and now_ns - sent.ended_ns < RESULT_WAIT_NS
            code = GoalStatusCode.ACTIVE if waits else code
        return GoalStatus(GoalId(self._text_of(goal.id), goal.stamp_ns), code, "")

    def _end(self, sent: _SentGoal, status: GoalStatusCode, text: str) -> None:
        sent.final = GoalStatus(GoalId(sent.text, 0), status, text)
        self._results.append(sent.final)
        self._changed = True

    def _text_of(self, goal_id: bytes) -> str:
        if self._sent is not None and self._sent.goal_id == goal_id:
            return self._sent.text
        return f"{self._prefix}{goal_id.hex()}" if goal_id.startswith(self._own) else goal_id.hex()

    def _id_of(self, text: str) -> bytes:
        if self._sent is not None and self._sent.text == text:
            return self._sent.goal_id
        return bytes.fromhex(text.removeprefix(self._prefix))
