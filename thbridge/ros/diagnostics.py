"""Log and diagnostics of a team: a log line for each event that people should know, and the state of each part."""

import math
from collections.abc import Iterator, Sequence

from sim.common.geometry import Pose2
from sim.common.observations import TICK
from sim.common.robot_numbers import namespace_of, robot_name
from sim.robot.navigator.navigation import NavigatorState
from sim.robot.software import PropagatedOutput, RobotOutput
from sim.snapshot import TeamSnapshot
from thbridge.ros.actionlib import ActionRequest, ActionServerMessage, GoalEnded, GoalSet
from thbridge.ros.messages.goal_status import GoalStatusCode
from thbridge.ros.messages.pack import DiagnosticLevel, DiagnosticStatus
from thbridge.ros.messages.records import CancelRequest, GoalRequest, LogLevel, LogLine
from thbridge.ros.names import CALLER, MAKES_WAY_FOR, NAVIGATION, RobotNames

SPREAD = 0.5
"""A robot counts as unsure if the standard deviation of its position is above this, meters."""
LOW_CHARGE = 0.2
"""If less than this fraction of the energy remains, there is a warning."""

_ENDS = {
    GoalStatusCode.SUCCEEDED: (LogLevel.INFO, "was reached"),
    GoalStatusCode.PREEMPTED: (LogLevel.INFO, "was preempted"),
    GoalStatusCode.RECALLED: (LogLevel.INFO, "was recalled before it started"),
    GoalStatusCode.ABORTED: (LogLevel.WARN, "was given up"),
}
_STATES: dict[NavigatorState, tuple[DiagnosticLevel, str]] = {
    "idle": (DiagnosticLevel.OK, "no goal"),
    "planning": (DiagnosticLevel.OK, "waits for a plan"),
    "controlling": (DiagnosticLevel.OK, "drives"),
    "clearing": (DiagnosticLevel.WARN, "tries to get free"),
}


class RobotDiagnostics:
    """Log lines and diagnostics of one robot.

    Args:
        robot: its index in the team.

    Attributes:
        changed: True if the robot began or stopped to make way for another robot in the last tick. Then its diagnostics
            are sent at once.
    """

    def __init__(self, robot: int) -> None:
        names = RobotNames.of(robot)
        self._robot = robot
        self._name = names.namespace[1:]
        self._navigator, self._localiser = names.topic("move_base"), names.topic("amcl")
        self._lost = False
        self._dead = False
        self._clears = False
        self._makes_way_for: int | None = None
        self._makes_way_since = 0
        self.changed = False
        self._collisions = 0
        self._given_up = ""
        self._fault = ""

    def log_lines(
        self, snapshot: TeamSnapshot, output: RobotOutput, goals: Sequence[ActionServerMessage]
    ) -> Iterator[LogLine]:
        """Yield a line for each change in a tick.

        Args:
            snapshot: the team in this tick.
            output: the output of this robot's software.
            goals: the messages of its action server.
        """
        dead = self._robot in snapshot.dead
        if dead != self._dead:
            self._dead = dead
            text = f"{self._name}'s software has stopped" if dead else f"{self._name}'s software runs again"
            yield LogLine(LogLevel.ERROR if dead else LogLevel.INFO, CALLER, text)
        collisions = int(snapshot.truth.collisions[self._robot])
        if collisions > self._collisions:
            yield LogLine(LogLevel.WARN, CALLER, f"{self._name} has hit something; collisions so far: {collisions}")
        self._collisions = collisions
        yield from self._way_made(snapshot.tick, None if dead else output.navigation.makes_way_for)
        if dead:
            return
        # Only robots that know where they are have extrapolated output. So this state has not changed since the last
        # tick.
        if not isinstance(output, PropagatedOutput) and output.estimate.lost != self._lost:
            self._lost = output.estimate.lost
            text = "the robot does not know where it is" if self._lost else "the robot knows where it is"
            yield LogLine(LogLevel.WARN if self._lost else LogLevel.INFO, self._localiser, text)
        # Only robots with a working localizer have extrapolated output. So there is no fault.
        fault = "" if isinstance(output, PropagatedOutput) else output.estimate.fault
        if fault and fault != self._fault:
            yield LogLine(LogLevel.ERROR, self._localiser, fault)
        self._fault = fault
        if output.navigation.fault:
            yield LogLine(LogLevel.ERROR, self._navigator, output.navigation.fault)
        clears = output.navigation.state == "clearing"
        if clears and not self._clears:
            yield LogLine(LogLevel.WARN, self._navigator, "path blocked: the robot tries to get free")
        self._clears = clears
        for message in goals:
            yield from self._goal(message)

    def _way_made(self, tick: int, robot: int | None) -> Iterator[LogLine]:
        """Yield a line if the robot starts or stops making way for another robot."""
        before, since = self._makes_way_for, self._makes_way_since
        self.changed = robot != before
        if not self.changed:
            return
        self._makes_way_for, self._makes_way_since = robot, tick
        if before is not None:
            lasted = (tick - since) * TICK
            yield LogLine(LogLevel.INFO, self._navigator, f"made way for {robot_name(before)} for {lasted:.1f} s")
        if robot is not None:
            yield LogLine(LogLevel.INFO, self._navigator, f"makes way for {robot_name(robot)}")

    def log_request(self, request: ActionRequest) -> Iterator[LogLine]:
        """Yield a line for a client's request. Yield nothing for a dead robot, which does not receive requests."""
        match request:
            case GoalRequest(_, goal_id, _, Pose2() as base) if not self._dead:
                yield LogLine(
                    LogLevel.INFO, self._navigator, f"a client's goal {goal_id}: ({base.x:.2f}, {base.y:.2f})"
                )
            case CancelRequest() if not self._dead:
                yield LogLine(LogLevel.INFO, self._navigator, "a client cancels goals")

    def _goal(self, message: ActionServerMessage) -> Iterator[LogLine]:
        match message:
            case GoalSet(goal, base):
                self._given_up = ""
                yield LogLine(LogLevel.INFO, self._navigator, f"goal {goal.id}: ({base.x:.2f}, {base.y:.2f})")
            case GoalEnded(entry) if entry.status in _ENDS:
                level, what = _ENDS[entry.status]
                self._given_up = entry.text if entry.status is GoalStatusCode.ABORTED else ""
                why = f": {entry.text}" if self._given_up else ""
                yield LogLine(level, self._navigator, f"goal {entry.goal.id} {what}{why}")

    def diagnoses(self, snapshot: TeamSnapshot, output: RobotOutput) -> Iterator[DiagnosticStatus]:
        """Yield the state of each part of the robot."""
        if self._robot in snapshot.dead:
            yield self._diagnosis(DiagnosticLevel.STALE, "software", "has stopped")
            return
        yield self._diagnosis(DiagnosticLevel.OK, "software", "runs")
        yield self._localisation(output)
        yield self._navigation(output)
        yield self._energy(output)
        contact = bool(snapshot.truth.contact[self._robot])
        level, message = (DiagnosticLevel.WARN, "touches something") if contact else (DiagnosticLevel.OK, "free")
        yield self._diagnosis(level, "bumper", message, collisions=str(self._collisions))

    def _localisation(self, output: RobotOutput) -> DiagnosticStatus:
        estimate = output.estimate
        var_x, var_y, var_theta = estimate.covariance.diagonal().tolist()
        spread = math.sqrt(max(var_x, var_y, 0.0))
        level, message = DiagnosticLevel.OK, "sure"
        if estimate.lost:
            level, message = DiagnosticLevel.ERROR, "lost"
        elif spread > SPREAD:
            level, message = DiagnosticLevel.WARN, "unsure"
        turn = math.degrees(math.sqrt(max(var_theta, 0.0)))
        figures = {
            "standard deviation of the position (m)": f"{spread:.3f}",
            "standard deviation of the heading (degrees)": f"{turn:.1f}",
        }
        return self._diagnosis(level, "localisation", message, **figures)

    def _navigation(self, output: RobotOutput) -> DiagnosticStatus:
        navigation = output.navigation
        level, message = _STATES[navigation.state]
        if navigation.goal is None and self._given_up:
            level, message = DiagnosticLevel.WARN, f"gave up: {self._given_up}"
        figures = {"distance left (m)": f"{navigation.remaining:.1f}"}
        first = navigation.makes_way_for
        if first is not None:
            message = f"{'' if level is DiagnosticLevel.OK else f'{message}, '}makes way for {robot_name(first)}"
            figures[MAKES_WAY_FOR] = namespace_of(first)
        elif navigation.waits_for is not None and level is DiagnosticLevel.OK:
            message = f"waits for {robot_name(navigation.waits_for)}, which is in its way"
        return self._diagnosis(level, NAVIGATION, message, **figures)

    def _energy(self, output: RobotOutput) -> DiagnosticStatus:
        battery = output.observations.battery
        level, message = DiagnosticLevel.OK, "enough"
        if battery.charge <= 0.0:
            level, message = DiagnosticLevel.ERROR, "none left"
        elif battery.charge < LOW_CHARGE * battery.capacity:
            level, message = DiagnosticLevel.WARN, "little left"
        return self._diagnosis(
            level, "energy", message, charge=f"{battery.charge:.1f}", capacity=f"{battery.capacity:.1f}"
        )

    def _diagnosis(self, level: DiagnosticLevel, part: str, message: str, **values: str) -> DiagnosticStatus:
        return DiagnosticStatus(level, f"{self._name}: {part}", message, self._name, values)
