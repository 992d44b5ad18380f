"""Client of a real robot's action server move_base. Every goal gets a result, even if the robot or the server fails.

Source: actionlib, simple_action_client.py and comm_state_machine.py, for the order of the server's messages;
move_base.cpp, for the texts of its results.
Differences from ROS: there is one goal at a time. The state of a goal is read from results and from status lists. A
result is sent only once and may be lost when the network breaks, but status lists are repeated. A goal that the server
does not list is sent a second time, because the server may have been restarted. Our goals that are no longer wanted are
cancelled until the server ends them. These include goals of an earlier run.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from sim.common.geometry import Pose2
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, GoalResult, NoPath, NoPathReason
from thbridge.ros.messages.goal_owners import GoalOwner
from thbridge.ros.messages.goal_status import ENDED, GoalId, GoalStatus, GoalStatusCode
from thbridge.ros.remote.pose import STALE_NS

UNLISTED_TIMEOUT_NS = 2_000_000_000
"""A goal counts as unknown to the server if the server's status lists do not contain it for this time."""
CANCEL_TIMEOUT_NS = 5_000_000_000
"""Maximum time between the cancel request for a goal and the end of the goal at the server."""
LOST_TIMEOUT_NS = 10_000_000_000
"""Time for which a robot is lost before its goal is aborted."""
PREEMPTION_WINDOW_NS = 1_000_000_000
"""Maximum time between the end of a goal and the message about the goal that preempted it."""
CANCEL_RETRY_NS = 1_000_000_000
"""Time between two attempts to cancel a goal that is no longer wanted."""

_REASONS: tuple[tuple[str, NoPathReason], ...] = (
    ("valid plan", "no_way"),
    ("valid control", "blocked_by_obstacle"),
    ("oscillating", "stuck"),
)
"""Reasons for failures, by words in the texts of move_base's results."""
NAV2_ERROR = "Nav2 error"
"""Words before the error code of Nav2 in the text of a result."""
_OF_NAV2: dict[int, NoPathReason] = {
    102: "lost",
    104: "robots_in_the_way",
    105: "stuck",
    106: "blocked_by_obstacle",
    202: "lost",
    203: "start_outside",
    204: "goal_outside",
    205: "start_occupied",
    206: "goal_occupied",
    208: "no_way",
    9002: "lost",
}
"""Reasons for error codes of nav2_msgs: those of FollowPath from 100, of ComputePathToPose from 200, of NavigateToPose
from 9000."""


@dataclass(frozen=True, slots=True)
class OutgoingGoal:
    """Goal that must be sent to the server."""

    goal_id: GoalId
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class OutgoingCancel:
    """Cancel request for the goal of this id. It must be sent to the server."""

    name: str


@dataclass(slots=True, eq=False)
class _ActiveGoal:
    """Current goal.

    Attributes:
        goal: the requested goal.
        goal_id: id of the goal at the server.
        sent_ns: time at which it was last sent.
        again: True if it was sent a second time.
        active: True while the server executes it.
        unlisted_ns: time since which the server's status lists do not contain it. None while they contain it.
        cancelled_ns: time of our cancel request. None if there was no request.
        withdrawn_ns: time at which another client preempted or cancelled it. Otherwise None.
    """

    goal: Goal
    goal_id: GoalId
    sent_ns: int
    again: bool = False
    active: bool = False
    unlisted_ns: int | None = None
    cancelled_ns: int | None = None
    withdrawn_ns: int | None = None


class MoveBaseClient:
    """Client that sends goals to one robot's action server and reports their results.

    Args:
        prefix: common prefix of the ids of all our goals for this robot. It is the same in every run.
        stale_ns: time without messages after which a server counts as dead.

    Attributes:
        outgoing: requests that must be sent to the server. The sender empties the list.
        results: results of goals, the oldest first. The reader removes them.
        resent: number of goals that were sent a second time, because the server did not list them.
    """

    def __init__(self, prefix: str, stale_ns: int = STALE_NS) -> None:
        self.outgoing: list[OutgoingGoal | OutgoingCancel] = []
        self.results: list[GoalResult] = []
        self.resent = 0
        self._prefix = prefix
        self._stale_ns = stale_ns
        self._sent = 0
        self._stamp_ns = 0
        self._current: _ActiveGoal | None = None
        self._status_ns: int | None = None
        self._listed: dict[str, GoalStatusCode] = {}
        self._foreign: dict[str, tuple[Pose2, int]] = {}
        self._last_cancel_ns: dict[str, int] = {}
        self._lost_ns: int | None = None

    @property
    def server_seen(self) -> bool:
        """True if the server has sent at least one status list."""
        return self._status_ns is not None

    def is_silent(self, now_ns: int) -> bool:
        """Return True if the server has sent messages before, but not for a long time."""
        return self._status_ns is not None and now_ns - self._status_ns > self._stale_ns

    @property
    def active(self) -> bool:
        """True while the server executes our goal."""
        return self._current is not None and self._current.active

    @property
    def sent_ns(self) -> int:
        """Time at which the current goal was sent. 0 without a goal."""
        return 0 if self._current is None else self._current.sent_ns

    def goal(self, now_ns: int, here: Pose2) -> Goal | None:
        """Return our current goal, or the goal of another client. `here` is used if the goal's pose is unknown."""
        if self._current is not None:
            return self._current.goal
        name = self._foreign_goal(now_ns)
        return None if name is None else Goal(0, self._foreign.get(name, (here, 0))[0], GoalOwner.STRANGER)

    def go(self, goal: Goal, now_ns: int) -> None:
        """Send the robot to a goal. The previous goal ends as cancelled."""
        if self._current is not None:
            self._finish(Cancelled(self._current.goal))
        self._send(goal, now_ns, again=False)

    def cancel(self, now_ns: int) -> None:
        """Cancel our goal. Goals of other clients remain."""
        current = self._current
        if current is not None and current.cancelled_ns is None:
            current.cancelled_ns = now_ns
            self.outgoing.append(OutgoingCancel(current.goal_id.id))

    def receive_goal(self, name: str, base_in_map: Pose2, now_ns: int) -> None:
        """Store a goal of another client."""
        self._foreign[name] = (base_in_map, now_ns)

    def receive_status(self, entries: Sequence[GoalStatus], now_ns: int) -> None:
        """Process a status list of the server."""
        self._status_ns = now_ns
        self._listed = {entry.goal.id: entry.status for entry in entries}
        self._foreign = {
            name: (pose, received_ns)
            for name, (pose, received_ns) in self._foreign.items()
            if name in self._listed or now_ns - received_ns < PREEMPTION_WINDOW_NS
        }
        current = self._current
        if current is not None and current.withdrawn_ns is None:
            entry = next((entry for entry in entries if entry.goal.id == current.goal_id.id), None)
            if entry is None:
                current.unlisted_ns = now_ns if current.unlisted_ns is None else current.unlisted_ns
            else:
                current.unlisted_ns = None
                current.active = entry.status in {GoalStatusCode.ACTIVE, GoalStatusCode.PREEMPTING}
                # The list also shows the end of a goal, in case the result message is lost.
                self.receive_result(entry, now_ns)
        self._cancel_strays(now_ns)

    def receive_result(self, entry: GoalStatus, now_ns: int) -> None:
        """Process the status of our goal from a result or a status list. Other goals are ignored."""
        current = self._current
        if current is None or entry.goal.id != current.goal_id.id or entry.status not in ENDED:
            return
        if entry.status is GoalStatusCode.SUCCEEDED:
            self._finish(GoalReached(current.goal))
        elif entry.status not in {GoalStatusCode.PREEMPTED, GoalStatusCode.RECALLED}:
            text = entry.text or f"the goal was {entry.status.name.lower()}, without a reason"
            self._finish(NoPath(current.goal, reason_of(entry.text), text))
        elif current.cancelled_ns is not None:
            self._finish(Cancelled(current.goal))
        elif current.withdrawn_ns is None:
            # Another client has ended the goal. `step` waits for a goal of that client.
            current.withdrawn_ns, current.active = now_ns, False

    def step(self, now_ns: int, *, lost: bool, stale: bool) -> None:
        """End the goal if the server will not end it, because of a timeout, a lost robot or a dead server.

        Args:
            now_ns: the time.
            lost: True if the robot does not know its pose.
            stale: True if no odometry has arrived for a long time.
        """
        self._lost_ns = None if not lost else now_ns if self._lost_ns is None else self._lost_ns
        current = self._current
        if current is None:
            return
        goal = current.goal
        if current.withdrawn_ns is not None:
            if self._foreign_goal(now_ns) is not None:
                self._finish(Cancelled(goal))
            elif now_ns - current.withdrawn_ns >= PREEMPTION_WINDOW_NS:
                self._finish(NoPath(goal, "called_off", "another client canceled the goal"))
        elif stale:
            self._finish(NoPath(goal, "unanswered", "the robot has become silent"))
        elif now_ns - max(current.sent_ns, self._status_ns or 0) > self._stale_ns:
            self._finish(NoPath(goal, "unanswered", "the action server has become silent"))
        elif current.cancelled_ns is not None and now_ns - current.cancelled_ns > CANCEL_TIMEOUT_NS:
            self._finish(Cancelled(goal))
        elif current.unlisted_ns is not None and now_ns - current.unlisted_ns > UNLISTED_TIMEOUT_NS:
            self._resend_or_give_up(current, now_ns)
        elif self._lost_ns is not None and now_ns - max(self._lost_ns, current.sent_ns) > LOST_TIMEOUT_NS:
            self.cancel(now_ns)
            self._finish(NoPath(goal, "lost", "the robot does not know where it is"))

    def _resend_or_give_up(self, current: _ActiveGoal, now_ns: int) -> None:
        """Send a goal that the server does not list a second time. If this was done before, end the goal as failed."""
        if current.cancelled_ns is not None:
            self._finish(Cancelled(current.goal))
        elif current.again:
            self._finish(NoPath(current.goal, "unanswered", "the action server does not take the goal"))
        else:
            self.resent += 1
            self._send(current.goal, now_ns, again=True)

    def _send(self, goal: Goal, now_ns: int, *, again: bool) -> None:
        self._sent += 1
        # A server recalls a goal that has an older time stamp than its current goal.
        self._stamp_ns = max(now_ns, self._stamp_ns + 1)
        seconds, nanoseconds = divmod(self._stamp_ns, 1_000_000_000)
        goal_id = GoalId(f"{self._prefix}{self._sent}-{seconds}.{nanoseconds:09d}", self._stamp_ns)
        self._current = _ActiveGoal(goal, goal_id, now_ns, again)
        self.outgoing.append(OutgoingGoal(goal_id, goal.base_in_map))

    def _finish(self, result: GoalResult) -> None:
        self._current = None
        self.results.append(result)

    def _foreign_goal(self, now_ns: int) -> str | None:
        """Return the id of another client's goal that is active or soon will be, or None."""
        if self._status_ns is not None and now_ns - self._status_ns <= self._stale_ns:
            for name, status in self._listed.items():
                if status not in ENDED and not name.startswith(self._prefix):
                    return name
        fresh = (
            name for name, (_, received_ns) in self._foreign.items() if now_ns - received_ns < PREEMPTION_WINDOW_NS
        )
        return next((name for name in fresh if self._listed.get(name) not in ENDED), None)

    def _cancel_strays(self, now_ns: int) -> None:
        # Other goals with our prefix are from an earlier run, or have already ended here. They must not move the robot.
        current = None if self._current is None else self._current.goal_id.id
        waiting = {name: at for name, at in self._last_cancel_ns.items() if name in self._listed}
        for name, status in self._listed.items():
            if (
                not name.startswith(self._prefix)
                or name == current
                or status not in {GoalStatusCode.PENDING, GoalStatusCode.ACTIVE}
            ):
                continue
            if name not in waiting or now_ns - waiting[name] >= CANCEL_RETRY_NS:
                waiting[name] = now_ns
                self.outgoing.append(OutgoingCancel(name))
        self._last_cancel_ns = waiting


def reason_of(text: str) -> NoPathReason:
    """Return the reason why move_base or Nav2 aborted a goal, from the text of its result.

    Other servers have other texts.
    """
    error = re.search(rf"{NAV2_ERROR} (\d{{1,5}})\b", text)
    if error is not None:
        return _OF_NAV2.get(int(error[1]), "gave_up")
    return next((reason for words, reason in _REASONS if words in text.lower()), "gave_up")
