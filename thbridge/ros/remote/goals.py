"""A client of a real robot's action server move_base: every goal ends, whatever becomes of robot and server.

Source: actionlib, simple_action_client.py and comm_state_machine.py, for what servers say when; move_base.cpp for the
texts of its results.
Differs: one goal at a time. How goals stand is taken from the list that the server says again and again as much as from
results, of which each is said once: a result may get lost when a network breaks. A goal that the server does not list
is sent once more, as the server may have been restarted. Goals of ours that nobody wants any more, of an earlier run
too, are cancelled until the server lets go of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from sim.common.geometry import Pose2
from sim.robot.navigator import Cancelled, Goal, GoalReached, GoalResult, NoPath
from sim.robot.navigator.goals import NoPathReason
from thbridge.ros.messages.goal_status import ENDED, GoalId, GoalStatus, GoalStatusCode
from thbridge.ros.remote.pose import STALE_NS

UNLISTED_TIMEOUT_NS = 2_000_000_000
"""A goal that the server's lists have not had for so long is not known to it."""
CANCEL_TIMEOUT_NS = 5_000_000_000
"""A server that has not let go of a goal for so long after it was taken back is not waited for."""
LOST_TIMEOUT_NS = 10_000_000_000
"""A robot that does not know for so long where it is gives its goal up."""
PREEMPTION_WINDOW_NS = 1_000_000_000
"""Between the end of a goal and the word about whatever took its place, at most."""
CANCEL_RETRY_NS = 1_000_000_000
"""From one attempt to cancel a stray goal to the next."""
FOREIGN_GOAL = -1
"""The number of goals that other clients set."""

_REASONS: tuple[tuple[str, NoPathReason], ...] = (
    ("valid plan", "no_way"),
    ("valid control", "blocked_by_obstacle"),
    ("oscillating", "stuck"),
)
"""What move_base's texts mean, by words of theirs."""


@dataclass(frozen=True, slots=True)
class SetGoal:
    """Send the robot somewhere."""

    goal_id: GoalId
    base_in_map: Pose2


@dataclass(frozen=True, slots=True)
class CancelGoal:
    """Take the goal of this name back."""

    name: str


@dataclass(slots=True, eq=False)
class _Pursuit:
    """The goal under way.

    Attributes:
        goal: what was asked for.
        goal_id: its name at the server.
        sent_ns: when it was sent last.
        again: whether it was sent once more.
        active: whether the server works on it.
        unlisted_ns: since when the server's lists lack it; None: they do not.
        cancelled_ns: when we have taken it back; None: we have not.
        withdrawn_ns: when it ended because of others; None: it did not.
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
    """One robot's goals.

    Args:
        prefix: what the names of all goals of ours to this robot begin with, in every run.
        silence_ns: a server that says nothing for so long does not work.

    Attributes:
        said: what is to be said to the server; whoever says it empties the list.
        results: how goals ended, oldest first; whoever tells of them takes them out.
    """

    def __init__(self, prefix: str, stale_ns: int = STALE_NS) -> None:
        self.outgoing: list[SetGoal | CancelGoal] = []
        self.results: list[GoalResult] = []
        self._prefix = prefix
        self._silence_ns = stale_ns
        self._sent = 0
        self._stamp_ns = 0
        self._pursuit: _Pursuit | None = None
        self._status_ns: int | None = None
        self._listed: dict[str, GoalStatusCode] = {}
        self._others: dict[str, tuple[Pose2, int]] = {}
        self._last_cancel_ns: dict[str, int] = {}
        self._lost_ns: int | None = None

    @property
    def server_seen(self) -> bool:
        """Whether the server was ever heard."""
        return self._status_ns is not None

    @property
    def active(self) -> bool:
        """Whether the server works on our goal."""
        return self._pursuit is not None and self._pursuit.active

    @property
    def sent_ns(self) -> int:
        """When the goal under way was sent; 0 without one."""
        return 0 if self._pursuit is None else self._pursuit.sent_ns

    def goal(self, now_ns: int, here: Pose2) -> Goal | None:
        """The goal under way, be it of another client; `here` stands for a goal whose place was not heard."""
        if self._pursuit is not None:
            return self._pursuit.goal
        name = self._other(now_ns)
        return None if name is None else Goal(FOREIGN_GOAL, self._others[name][0] if name in self._others else here)

    def go(self, goal: Goal, now_ns: int) -> None:
        """Send the robot there; the goal before ends."""
        if self._pursuit is not None:
            self._finish(Cancelled(self._pursuit.goal))
        self._send(goal, now_ns, again=False)

    def halt(self, now_ns: int) -> None:
        """Take our goal back; those of others stay."""
        pursuit = self._pursuit
        if pursuit is not None and pursuit.cancelled_ns is None:
            pursuit.cancelled_ns = now_ns
            self.outgoing.append(CancelGoal(pursuit.goal_id.id))

    def receive_goal(self, name: str, base_in_map: Pose2, now_ns: int) -> None:
        """Another client set a goal."""
        self._others[name] = (base_in_map, now_ns)

    def receive_status(self, entries: Sequence[GoalStatus], now_ns: int) -> None:
        """The server told how all goals stand."""
        self._status_ns = now_ns
        self._listed = {entry.goal.id: entry.status for entry in entries}
        self._others = {
            name: (pose, heard_ns)
            for name, (pose, heard_ns) in self._others.items()
            if name in self._listed or now_ns - heard_ns < PREEMPTION_WINDOW_NS
        }
        pursuit = self._pursuit
        if pursuit is not None and pursuit.withdrawn_ns is None:
            entry = next((entry for entry in entries if entry.goal.id == pursuit.goal_id.id), None)
            if entry is None:
                pursuit.unlisted_ns = now_ns if pursuit.unlisted_ns is None else pursuit.unlisted_ns
            else:
                pursuit.unlisted_ns = None
                pursuit.active = entry.status in {GoalStatusCode.ACTIVE, GoalStatusCode.PREEMPTING}
                self.receive_result(entry, now_ns)
        self._cancel_strays(now_ns)

    def receive_result(self, entry: GoalStatus, now_ns: int) -> None:
        """A result came, or a list told how our goal stands; the ends of other goals are not ours."""
        pursuit = self._pursuit
        if pursuit is None or entry.goal.id != pursuit.goal_id.id or entry.status not in ENDED:
            return
        if entry.status is GoalStatusCode.SUCCEEDED:
            self._finish(GoalReached(pursuit.goal))
        elif entry.status not in {GoalStatusCode.PREEMPTED, GoalStatusCode.RECALLED}:
            text = entry.text or f"the goal was {entry.status.name.lower()}, without a reason"
            self._finish(NoPath(pursuit.goal, reason_of(entry.text), text))
        elif pursuit.cancelled_ns is not None:
            self._finish(Cancelled(pursuit.goal))
        elif pursuit.withdrawn_ns is None:
            pursuit.withdrawn_ns, pursuit.active = now_ns, False

    def step(self, now_ns: int, *, lost: bool, stale: bool) -> None:
        """Time has passed: end what will not end by itself.

        Args:
            now_ns: the time.
            lost: whether the robot does not know where it is.
            silent: whether nothing was heard of it for long.
        """
        self._lost_ns = None if not lost else now_ns if self._lost_ns is None else self._lost_ns
        pursuit = self._pursuit
        if pursuit is None:
            return
        goal = pursuit.goal
        if pursuit.withdrawn_ns is not None:
            if self._other(now_ns) is not None:
                self._finish(Cancelled(goal))
            elif now_ns - pursuit.withdrawn_ns >= PREEMPTION_WINDOW_NS:
                self._finish(NoPath(goal, "called_off", "somebody else took the goal back"))
        elif stale:
            self._finish(NoPath(goal, "unanswered", "the robot says nothing any more"))
        elif now_ns - max(pursuit.sent_ns, self._status_ns or 0) > self._silence_ns:
            self._finish(NoPath(goal, "unanswered", "the action server says nothing any more"))
        elif pursuit.cancelled_ns is not None and now_ns - pursuit.cancelled_ns > CANCEL_TIMEOUT_NS:
            self._finish(Cancelled(goal))
        elif pursuit.unlisted_ns is not None and now_ns - pursuit.unlisted_ns > UNLISTED_TIMEOUT_NS:
            self._forgotten(pursuit, now_ns)
        elif self._lost_ns is not None and now_ns - max(self._lost_ns, pursuit.sent_ns) > LOST_TIMEOUT_NS:
            self.halt(now_ns)
            self._finish(NoPath(goal, "lost", "the robot does not know where it is"))

    def _forgotten(self, pursuit: _Pursuit, now_ns: int) -> None:
        """The server does not know the goal."""
        if pursuit.cancelled_ns is not None:
            self._finish(Cancelled(pursuit.goal))
        elif pursuit.again:
            self._finish(NoPath(pursuit.goal, "unanswered", "the action server does not take the goal"))
        else:
            self._send(pursuit.goal, now_ns, again=True)

    def _send(self, goal: Goal, now_ns: int, *, again: bool) -> None:
        self._sent += 1
        # A server takes a goal that is older than the one it has for one that came too late.
        self._stamp_ns = max(now_ns, self._stamp_ns + 1)
        seconds, nanoseconds = divmod(self._stamp_ns, 1_000_000_000)
        goal_id = GoalId(f"{self._prefix}{self._sent}-{seconds}.{nanoseconds:09d}", self._stamp_ns)
        self._pursuit = _Pursuit(goal, goal_id, now_ns, again)
        self.outgoing.append(SetGoal(goal_id, goal.base_in_map))

    def _finish(self, result: GoalResult) -> None:
        self._pursuit = None
        self.results.append(result)

    def _other(self, now_ns: int) -> str | None:
        """The goal of another client that is under way, or about to be."""
        if self._status_ns is not None and now_ns - self._status_ns <= self._silence_ns:
            for name, status in self._listed.items():
                if status not in ENDED and not name.startswith(self._prefix):
                    return name
        fresh = (name for name, (_, heard_ns) in self._others.items() if now_ns - heard_ns < PREEMPTION_WINDOW_NS)
        return next((name for name in fresh if self._listed.get(name) not in ENDED), None)

    def _cancel_strays(self, now_ns: int) -> None:
        current = None if self._pursuit is None else self._pursuit.goal_id.id
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
                self.outgoing.append(CancelGoal(name))
        self._last_cancel_ns = waiting


def reason_of(text: str) -> NoPathReason:
    """Why move_base has given up, by the text of its result; other servers have their own texts."""
    return next((reason for words, reason in _REASONS if words in text.lower()), "gave_up")
