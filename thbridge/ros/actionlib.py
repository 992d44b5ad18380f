"""Action server move_base of one robot. It stores a list of all goals with their states for its clients.

Clients set and cancel goals. The game is one of these clients. A newer goal replaces an older goal. The server is
called twice per tick: `take` converts the requests of clients to inputs of the navigator. `follow` reads the actions of
the navigator and returns the messages to publish. The same requests and the same navigation give the same messages. So
the program that moves the robot and the program that records may each have a server.

Source: actionlib, action_server.py, simple_action_server.py and server_goal_handle.py; ros-planning/navigation,
move_base.cpp.
Differences from ROS: there are no threads. In each tick, all requests are read before the newest goal is accepted. A
goal of the game is active whatever its time stamp is, because the navigator has accepted it. A simple goal (a pose
without an id) gets its id before it is published, so that its result can be found. While a robot is dead, its server is
dead, too.
Active goals end when the robot is revived. The number of ended goals in the list is limited, even if clients set very
many goals.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias, assert_never

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND
from sim.inputs import CancelGoal, SendGoal
from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, GoalResult, NoPath
from sim.robot.navigator.navigation import Navigation
from thbridge.ros.messages.goal_owners import GoalOwner, recorded_number
from thbridge.ros.messages.goal_status import ENDED, GoalId, GoalStatus, GoalStatusCode
from thbridge.ros.messages.records import CancelRequest, GoalRequest, SimpleGoal
from thbridge.ros.messages.stamps import stamp_ns
from thbridge.ros.names import RobotNames

STATUS_PERIOD = TICKS_PER_SECOND // 5
"""Ticks between two status lists if no goal changes. ROS's parameter for this is actionlib_status_frequency."""
FEEDBACK_PERIOD = TICKS_PER_SECOND // 10
"""Ticks between two feedback messages."""
LISTED_NS = 5_000_000_000
"""Nanoseconds after its end for which a goal stays in the status list. ROS's parameter for this is
status_list_timeout."""
LISTED = 64
"""Maximum number of ended goals in the status list. The list is published at every change of a goal."""

ActionRequest: TypeAlias = GoalRequest | CancelRequest | SimpleGoal

REPLACED = "replaced by a newer goal"
"""Text of a goal that was preempted by another goal."""
_ACCEPTED = "under way"
_TAKEN_BACK = "canceled before it arrived"
_DIED = "the robot stopped working"


@dataclass(frozen=True, slots=True)
class GoalSet:
    """Goal that no client of the action has set: a goal of the game, or a simple goal."""

    goal: GoalId
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class StatusList:
    """States of all goals, including recently ended goals."""

    entries: tuple[GoalStatus, ...]


@dataclass(frozen=True, slots=True)
class Feedback:
    """Progress of the goal to which the robot is driving. The message also contains the robot's pose."""

    entry: GoalStatus


@dataclass(frozen=True, slots=True)
class GoalEnded:
    """Final state of a goal."""

    entry: GoalStatus


ActionServerMessage: TypeAlias = GoalSet | StatusList | Feedback | GoalEnded


@dataclass(slots=True, eq=False)
class _Entry:
    """Goal in the list of an action server.

    Attributes:
        goal: its id and time stamp.
        status: its state.
        text: reason for this state, for people.
        target: the navigator's goal. None if the pose cannot be used.
        refusal: reason why the pose cannot be used.
        came: True if the goal itself was received. A cancel request may arrive before its goal.
        left_ns: time of its end. None before its end. After its end, it stays in the list for `LISTED_NS`.
    """

    goal: GoalId
    status: GoalStatusCode
    text: str = ""
    target: Goal | None = None
    refusal: str = ""
    came: bool = True
    left_ns: int | None = None

    @property
    def is_active(self) -> bool:
        return self.status is GoalStatusCode.ACTIVE or self.status is GoalStatusCode.PREEMPTING

    def report(self) -> GoalStatus:
        return GoalStatus(self.goal, self.status, self.text)


class MoveBaseServer:
    """Action server of one robot.

    Args:
        robot: its index in the team.
    """

    def __init__(self, robot: int) -> None:
        self._robot = robot
        self._names = RobotNames.of(robot)
        self._listed: list[_Entry] = []
        self._current: _Entry | None = None
        self._next: _Entry | None = None
        self._last_cancel_ns = 0
        self._named = 0
        self._now = 0
        self._driven: Goal | None = None
        self._cancelled: _Entry | None = None
        self._dead = False
        self._outgoing: list[ActionServerMessage] = []
        self._followed: Navigation | None = None

    def take(self, tick: int, requests: Sequence[ActionRequest]) -> list[SendGoal | CancelGoal]:
        """Process the requests of clients before the robots' tick.

        Args:
            tick: tick in which the robot's navigator executes the returned inputs.
            requests: requests to this robot, in their order.

        Returns:
            Inputs of the navigator. A dead robot has no inputs.
        """
        # Without requests, the last call has settled everything.
        if self._dead or not requests:
            return []
        self._now = stamp_ns(tick)
        for request in requests:
            match request:
                case GoalRequest(_, goal_id, stamp, base, number, refusal):
                    target = None if base is None else Goal(number, base, GoalOwner.ROS_CLIENT)
                    self._receive_goal(GoalId(goal_id, stamp), target, refusal)
                case SimpleGoal(_, base, number, refusal, owner):
                    target = None if base is None else Goal(number, base, owner)
                    goal = GoalId(self._new_name(), self._now)
                    if base is not None:
                        self._outgoing.append(GoalSet(goal, base))
                    self._receive_goal(goal, target, refusal)
                case CancelRequest(_, goal_id, stamp):
                    self._receive_cancel(GoalId(goal_id, stamp))
                case _:
                    assert_never(request)
        return self._execute()

    def follow(self, tick: int, navigation: Navigation | None) -> list[ActionServerMessage]:
        """Process the actions of the navigator in a tick, and return the messages to publish.

        Args:
            tick: the number of the tick.
            navigation: the navigator's output of this tick. None if the robot is dead.
        """
        if navigation is None:
            self._dead, self._followed = True, None
            return []
        # An output without a result that was already processed changes nothing.
        if navigation is self._followed and not self._outgoing and tick % FEEDBACK_PERIOD:
            return []
        self._followed = navigation
        self._now = stamp_ns(tick)
        if self._dead:
            self._revive()
        if navigation.result is not None:
            self._end_driven(navigation.result)
        goal = navigation.goal
        if goal is not None and goal is not self._driven and goal != self._driven:
            self._adopt(goal)
        self._driven = goal
        if tick % FEEDBACK_PERIOD == 0 and self._current is not None and self._current.is_active:
            self._outgoing.append(Feedback(self._current.report()))
        if tick % STATUS_PERIOD == 0:
            self._publish_status()
        outgoing, self._outgoing = self._outgoing, []
        return outgoing

    def pass_to(self, tick: int) -> None:
        """Record a tick in which the navigator did nothing. Nothing is published; old goals leave the list."""
        if tick % STATUS_PERIOD == 0 and not self._dead:
            self._now = stamp_ns(tick)
            self._publish_status()
            self._outgoing.clear()

    # Requests of clients

    def _receive_goal(self, goal: GoalId, target: Goal | None, refusal: str) -> None:
        known = next((entry for entry in self._listed if entry.goal.id == goal.id), None)
        if known is not None:
            # A goal that was cancelled before it arrived ends at once. A known goal that arrives again is ignored.
            if known.status is GoalStatusCode.RECALLING:
                self._end(known, GoalStatusCode.RECALLED, known.text)
            elif not known.came:
                known.left_ns = self._now
            return
        named = GoalId(goal.id or self._new_name(), goal.stamp_ns or self._now)
        entry = _Entry(named, GoalStatusCode.PENDING, target=target, refusal=refusal)
        self._listed.append(entry)
        # A goal without a time stamp is never too old. So the client's stamp is compared, not the stamp that the server
        # fills in.
        if 0 < goal.stamp_ns <= self._last_cancel_ns:
            self._end(entry, GoalStatusCode.RECALLED, _TAKEN_BACK)
        elif any(other is not None and named.stamp_ns < other.goal.stamp_ns for other in (self._current, self._next)):
            self._end(entry, GoalStatusCode.RECALLED, REPLACED)
        else:
            waiting = self._next
            if waiting is not None and waiting is not self._current and waiting.status not in ENDED:
                self._end(waiting, GoalStatusCode.RECALLED, REPLACED)
            self._next = entry

    def _receive_cancel(self, cancelled: GoalId) -> None:
        # In actionlib, an empty id with time 0 cancels all goals, and a time cancels all goals up to this time.
        everything = not cancelled.id and cancelled.stamp_ns == 0
        found = False
        for entry in self._listed:
            named = entry.goal.id == cancelled.id
            found = found or named
            older = cancelled.stamp_ns > 0 and entry.goal.stamp_ns <= cancelled.stamp_ns
            if not (everything or named or older):
                continue
            if not entry.came:
                entry.left_ns = self._now
            elif entry.status is GoalStatusCode.PENDING:
                entry.status = GoalStatusCode.RECALLING
                self._publish_status()
            elif entry.status is GoalStatusCode.ACTIVE:
                entry.status = GoalStatusCode.PREEMPTING
                self._publish_status()
        if cancelled.id and not found:
            # A cancel request may arrive before its goal.
            self._listed.append(_Entry(cancelled, GoalStatusCode.RECALLING, came=False, left_ns=self._now))
        self._last_cancel_ns = max(self._last_cancel_ns, cancelled.stamp_ns)

    def _new_name(self) -> str:
        self._named += 1
        seconds, nanoseconds = divmod(self._now, 1_000_000_000)
        return f"{self._names.topic('move_base')}-{self._named}-{seconds}.{nanoseconds}"

    # Effects on the navigator

    def _execute(self) -> list[SendGoal | CancelGoal]:
        current, entry = self._current, self._next
        if entry is None or entry is current or entry.status in ENDED:
            self._next = current
            if current is not None and current.status is GoalStatusCode.PREEMPTING and self._cancelled is not current:
                self._cancelled = current
                return [CancelGoal(self._robot)]
            return []
        # A new goal preempts the current goal. Even if the robot cannot drive to the new goal, it must stop, because
        # the earlier goal has ended.
        drives = current is not None and current.is_active
        self._replace_current(entry)
        entry.status = GoalStatusCode.ACTIVE if entry.status is GoalStatusCode.PENDING else GoalStatusCode.PREEMPTING
        entry.text = _ACCEPTED
        self._publish_status()
        if entry.target is None:
            self._end(entry, GoalStatusCode.ABORTED, entry.refusal)
        elif entry.status is GoalStatusCode.PREEMPTING:
            self._end(entry, GoalStatusCode.PREEMPTED, "")
        else:
            return [SendGoal(self._robot, entry.target)]
        return [CancelGoal(self._robot)] if drives else []

    def _replace_current(self, entry: _Entry) -> None:
        if self._current is not None and self._current.is_active:
            self._end(self._current, GoalStatusCode.PREEMPTED, REPLACED)
        self._current = self._next = entry

    def _end_driven(self, result: GoalResult) -> None:
        """Process the navigator's result of a goal."""
        known = [entry for entry in self._listed if entry.target == result.goal]
        entry = next((entry for entry in known if entry.is_active), None)
        if entry is None and not known:
            entry = self._adopt(result.goal)  # The goal was set and ended within one tick.
        self._driven = None
        if entry is None:
            return  # The end of the goal is already published.
        match result:
            case GoalReached():
                self._end(entry, GoalStatusCode.SUCCEEDED, "Goal reached.")
            case NoPath(_, _, sentence):
                self._end(entry, GoalStatusCode.ABORTED, sentence)
            case Cancelled():
                self._end(entry, GoalStatusCode.PREEMPTED, "")
            case _:
                assert_never(result)

    def _adopt(self, goal: Goal) -> _Entry | None:
        """Add a goal that the navigator has accepted from the game. Return None if it is a known goal of a client."""
        if any(entry.target == goal and entry.is_active for entry in self._listed):
            return None
        named = GoalId(f"{self._names.namespace[1:]}-{recorded_number(goal.owner, goal.id)}", self._now)
        # The game may set the same goal again.
        self._listed = [entry for entry in self._listed if entry.goal.id != named.id]
        entry = _Entry(named, GoalStatusCode.ACTIVE, _ACCEPTED, goal)
        self._replace_current(entry)
        self._listed.append(entry)
        self._outgoing.append(GoalSet(named, goal.base_in_map))
        self._publish_status()
        return entry

    def _revive(self) -> None:
        self._dead = False
        self._driven = None
        for entry in list(self._listed):
            if entry.is_active:
                self._end(entry, GoalStatusCode.PREEMPTED, _DIED)

    def _end(self, entry: _Entry, status: GoalStatusCode, text: str) -> None:
        entry.status, entry.text, entry.left_ns = status, text, self._now
        self._outgoing.append(GoalEnded(entry.report()))
        self._publish_status()

    def _publish_status(self) -> None:
        left = [entry for entry in self._listed if entry.left_ns is not None]
        dropped = {entry for entry in left if (entry.left_ns or 0) + LISTED_NS < self._now} | {*left[:-LISTED]}
        self._listed = [entry for entry in self._listed if entry not in dropped]
        self._outgoing.append(StatusList(tuple(entry.report() for entry in self._listed)))
