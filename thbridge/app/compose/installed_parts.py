"""Loading and supervision of parts of robots' software that studies name as plug-ins."""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.observations import Imu, LaserMount, Odometry, Scan, Twist
from sim.numerics import elementary_arrays
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.parameters import LaserParameters, PartKind, RobotParameters, installed_names
from sim.robot.costmap.costs import INSCRIBED, LETHAL, CostFrame, Costs
from sim.robot.global_planning.path import Path, PathSearch, PlanRefusal, RobotPathPlanner, headings, plan_refusal
from sim.robot.installed_parts import InstalledParts
from sim.robot.localization.estimate import Estimate, Localizer, LocalizerFactory, read_only
from sim.robot.navigator.recovery import RecoveryFactory, RecoverySituation, RunningRecovery
from sim.robot.part_failure import PartFailed
from sim.world.sensors import mount_of
from thbridge.app.compose.installed import FaultLog
from thbridge.dialogue.other_programs import RAISED, told_error
from thbridge.files.plugins import printing_aside
from thbridge.study.plugins import PART_KINDS

T = TypeVar("T")


class PartCaller(Protocol):
    """Function that calls a lab's program and returns its result."""

    def __call__(self, asked: Callable[[], T], /) -> T:
        """Call the program, and return the result."""
        ...


@dataclass(frozen=True, slots=True)
class PartGuard:
    """Guard of a part, which converts exceptions of the lab's program into `PartFailed`, and logs each of them once.

    Attributes:
        what: kind and name of the part.
        log: callback with each failure.
        run: function that calls the lab's program; in a trial, it has a timeout.
    """

    what: str
    log: Callable[[str], None]
    run: PartCaller

    def call(self, asked: Callable[[], T], wrong: Callable[[object], str] = lambda _: "") -> T:
        """Return the result of a call.

        Args:
            asked: function that calls the lab's program.
            wrong: function that returns the problem of a result; empty if there is no problem.

        Raises:
            PartFailed: the call raised an error, or the result is wrong.
        """
        try:
            with printing_aside():
                returned = self.run(asked)
            problem = wrong(returned)
        except RAISED as error:
            raise self.failed(told_error(error)) from error
        if problem:
            raise self.failed(problem)
        return returned

    def failed(self, problem: str) -> PartFailed:
        """Log a problem of the part, and return the exception for it."""
        self.log(problem)
        return PartFailed(f"the {self.what} failed: {problem}")


@dataclass(frozen=True, slots=True)
class GuardedRecoveryFactory:
    """Factory of a lab's recovery behavior; see `RecoveryFactory`.

    Attributes:
        factory: the lab's factory.
        guard: guard of the behavior.
    """

    factory: RecoveryFactory
    guard: PartGuard

    def __call__(self, seed: int, /) -> RunningRecovery:
        """Return a guarded recovery behavior."""
        return GuardedRecovery(self.guard.call(lambda: self.factory(seed)), self.guard)


@dataclass(frozen=True, slots=True)
class GuardedRecovery:
    """Recovery behavior of a lab.

    Attributes:
        behavior: the lab's behavior.
        guard: guard of all calls.
    """

    behavior: RunningRecovery
    guard: PartGuard

    def command(self, now: RecoverySituation) -> Twist | None:
        """Return the behavior's command; see `RunningRecovery`."""
        said = self.guard.call(lambda: self.behavior.command(now), _wrong_command)
        return None if said is None else Twist(float(said.linear), float(said.angular))


def _wrong_command(said: object) -> str:
    if said is None:
        return ""
    if not isinstance(said, Twist):
        return f"a {type(said).__name__} is neither a Twist nor None"
    if not (math.isfinite(said.linear) and math.isfinite(said.angular)):
        return f"the command ({said.linear}, {said.angular}) is not finite"
    return ""


@dataclass(frozen=True, slots=True)
class GuardedLocalizerFactory:
    """Factory of a lab's localizer; see `LocalizerFactory`.

    Attributes:
        factory: the lab's factory.
        guard: guard of the localizer.
    """

    factory: LocalizerFactory
    guard: PartGuard

    def __call__(self, parameters: RobotParameters, grid: OccupancyGrid, mount: LaserMount, seed: int, /) -> Localizer:
        """Return a guarded localizer."""
        return GuardedLocalizer(lambda: self.factory(parameters, grid, mount, seed), self.guard)


class GuardedLocalizer:
    """Localizer of a lab. After a failure, the robot counts as lost, and odometry extrapolates the last estimate.

    Args:
        make: function that builds the lab's localizer.
        guard: guard of all calls.
    """

    def __init__(self, make: Callable[[], Localizer], guard: PartGuard) -> None:
        self._guard = guard
        self._localizer: Localizer | None = None
        self._covariance = read_only(np.zeros((3, 3)))
        self._odom_in_map = Pose2(0.0, 0.0, 0.0)
        # Pose that a request has set. This pose and the next odometry give the correction of the odometry frame.
        self._base_in_map: Pose2 | None = None
        self._fault = ""
        try:
            self._localizer = guard.call(make)
        except PartFailed as failed:
            self._fault = str(failed)

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Begin at a pose; see `Localizer`."""
        self._base_in_map, self._covariance = base_in_map, read_only(covariance.copy())
        self._pass_on(lambda localizer: localizer.start(base_in_map, covariance.copy()))

    def globalize(self) -> None:
        """Forget the pose; see `Localizer`."""
        self._pass_on(lambda localizer: localizer.globalize())

    def widen(self, distance: float, turn: float) -> None:
        """Increase the uncertainty of the pose; see `Localizer`."""
        self._pass_on(lambda localizer: localizer.widen(distance, turn))

    def request_update(self) -> None:
        """Use the next scan even if the robot has not moved; see `Localizer`."""
        self._pass_on(lambda localizer: localizer.request_update())

    def configure(self, parameters: RobotParameters) -> None:
        """Continue with new parameters; see `Localizer`."""
        self._pass_on(lambda localizer: localizer.configure(parameters))

    def _pass_on(self, request: Callable[[Localizer], None]) -> None:
        """Pass a request to the lab's localizer. If the request fails, the next update reports the failure."""
        localizer = self._localizer
        if localizer is not None:
            try:
                self._guard.call(lambda: request(localizer))
            except PartFailed as failed:
                self._fault = str(failed)

    @property
    def awaits_scan(self) -> bool:
        """False, because the lab's localizer is also updated in ticks without a scan."""
        return False

    def ignores_scans(self, odometry: Odometry) -> bool:
        """Return False; see `awaits_scan`."""
        return False

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Return the lab's estimate. After a failure, return the estimate of a lost robot; see `Localizer`."""
        if self._base_in_map is not None:
            self._odom_in_map = self._base_in_map.compose(odometry.base_in_odom.inverse())
            self._base_in_map = None
        if (localizer := self._localizer) is not None and not self._fault:
            given = None if scan is None else replace(scan, ranges=scan.ranges.copy())
            try:
                said = self._guard.call(lambda: localizer.update(odometry, imu, given), _wrong_estimate)
            except PartFailed as failed:
                self._fault = str(failed)
            else:
                return self._accepted(said, odometry)
        base_in_map = self._odom_in_map.compose(odometry.base_in_odom)
        # The failure of a call is reported once. If the localizer could not be built, the failure is permanent.
        fault, self._fault = self._fault, self._fault if self._localizer is None else ""
        return Estimate(
            odometry.tick, base_in_map, self._odom_in_map, self._covariance, _NO_PARTICLES, False, True, fault=fault
        )

    def _accepted(self, said: Estimate, odometry: Odometry) -> Estimate:
        """Return a copy of an estimate, with the odometry correction that follows from the pose."""
        base = said.base_in_map
        base_in_map = Pose2(float(base.x), float(base.y), wrap_angle(float(base.theta)))
        self._odom_in_map = base_in_map.compose(odometry.base_in_odom.inverse())
        self._covariance = read_only(np.array(said.covariance, np.float64))
        particles = read_only(np.array(said.particles, np.float64))
        return Estimate(
            odometry.tick,
            base_in_map,
            self._odom_in_map,
            self._covariance,
            particles,
            bool(said.updated),
            bool(said.lost),
            said.agreement,
            said.p_wrong,
        )


class PathFinder(Protocol):
    """Global planner of a lab (in ROS: nav_core::BaseGlobalPlanner)."""

    def plan(self, costs: Costs, frame: CostFrame, start: Pose2, goal: Pose2, /) -> FloatArray | None:
        """Return (m, 2) points or (m, 3) poses from start to goal; None if there is no path.

        Args:
            costs: (rows, cols) costs of the whole map; read-only.
            frame: position of the costs on the map.
            start: pose of the robot's base.
            goal: pose of the robot's base at the goal.
        """


class PathFinderFactory(Protocol):
    """Factory of a lab's global planner: a class or a function."""

    def __call__(self, parameters: RobotParameters, seed: int, /) -> PathFinder:
        """Return the planner of one robot.

        Args:
            parameters: parameters of the robot's software.
            seed: random seed, different for each robot.
        """
        ...


@dataclass(frozen=True, slots=True)
class GuardedPlannerFactory:
    """Factory of a lab's global planner; see `PlannerFactory`.

    Attributes:
        factory: the lab's factory.
        guard: guard of the planner.
    """

    factory: PathFinderFactory
    guard: PartGuard

    def __call__(self, parameters: RobotParameters, seed: int, /) -> RobotPathPlanner:
        """Return a guarded planner."""
        return GuardedPlanner(lambda: self.factory(parameters, seed), self.guard)


class GuardedPlanner:
    """Global planner of a lab whose paths are checked.

    Args:
        make: function that builds the lab's planner; it is called at the first request for a path.
        guard: guard of all calls.
    """

    def __init__(self, make: Callable[[], PathFinder], guard: PartGuard) -> None:
        self._make = make
        self._guard = guard
        self._finder: PathFinder | None = None

    def search(self, costs: Costs, frame: CostFrame, start: Pose2, goal: Pose2) -> PathSearch:
        """Search a path in a single step; see `PathPlanner`. Raises PartFailed: the planner failed."""
        yield from ()
        return self.plan(costs, frame, start, goal)

    def plan(self, costs: Costs, frame: CostFrame, start: Pose2, goal: Pose2) -> Path | PlanRefusal:
        """Plan a path at once; see `RobotPathPlanner`. Raises PartFailed: the planner failed."""
        if _cost_at(costs, frame, start) is None:
            return plan_refusal("start_outside")
        at_goal = _cost_at(costs, frame, goal)
        if at_goal is None or at_goal in _OCCUPIED:
            return plan_refusal("goal_outside" if at_goal is None else "goal_occupied")
        given = costs.copy()
        given.setflags(write=False)

        def find() -> FloatArray | None:
            if self._finder is None:
                self._finder = self._make()
            found = self._finder.plan(given, frame, start, goal)
            return None if found is None else np.array(found, np.float64)

        points = self._guard.call(find, lambda found: _wrong_path(found, given, frame, start, goal))
        if points is None:
            return plan_refusal("no_way")
        line = np.vstack([start.array()[:2], points[1:-1, :2], goal.array()[:2]])
        # Repeated points are dropped, because two equal points do not define a heading.
        moved = np.append(True, (np.diff(line, axis=0) != 0.0).any(axis=1))
        line = line[moved] if moved[1:].any() else line[[0, -1]]
        return Path(headings(line, goal.theta))

    def reached(self, costs: Costs, frame: CostFrame, start: Pose2) -> NDArray[np.bool_]:
        """Return (rows, cols) True for all free cells. Only a plan would show which cells a lab's planner reaches."""
        return costs < INSCRIBED


_OCCUPIED = (INSCRIBED, LETHAL)
END_TOLERANCE = 0.2
"""Largest distance from the robot to the start of a lab's path, and from the path's end to the goal, meters."""


def _wrong_path(found: object, costs: Costs, frame: CostFrame, start: Pose2, goal: Pose2) -> str:
    if found is None:
        return ""
    points = np.asarray(found)
    if points.ndim != 2 or points.shape[1] not in (2, 3) or not len(points) or not np.isfinite(points).all():
        return "its path is not an (m, 2) or (m, 3) array of finite numbers"
    for what, end, place in (("begins", points[0], start), ("ends", points[-1], goal)):
        away = float(elementary_arrays.hypot(end[0] - place.x, end[1] - place.y))
        if away > END_TOLERANCE:
            return f"its path {what} {away:.2f} m from the {'robot' if what == 'begins' else 'goal'}"
    ends = np.vstack([start.array()[:2], points[1:-1, :2], goal.array()[:2]])
    steps = elementary_arrays.hypot(*np.diff(ends, axis=0).T)
    for (x, y), (u, v), step in zip(ends[:-1].tolist(), ends[1:].tolist(), steps.tolist(), strict=True):
        parts = max(1, math.ceil(step / frame.resolution))
        for part in range(parts + 1):
            at = Pose2(x + (u - x) * part / parts, y + (v - y) * part / parts, 0.0)
            cost = _cost_at(costs, frame, at)
            # Near the robot, the path may touch an obstacle, because the robot may have to leave an obstacle.
            if at.distance(start) > NEAR_ROBOT and (cost is None or cost in _OCCUPIED):
                return f"its path leads through an obstacle at ({at.x:.2f}, {at.y:.2f})"
    return ""


NEAR_ROBOT = 0.5
"""A path may touch obstacles within this distance of the robot, meters."""


def _cost_at(costs: Costs, frame: CostFrame, place: Pose2) -> int | None:
    """Return the cost of the cell at a place; None outside the map."""
    row, col = math.floor((place.y - frame.y) / frame.resolution), math.floor((place.x - frame.x) / frame.resolution)
    return int(costs[row, col]) if 0 <= row < costs.shape[0] and 0 <= col < costs.shape[1] else None


_NO_PARTICLES = read_only(np.empty((0, 3)))


def _wrong_estimate(said: object) -> str:
    if not isinstance(said, Estimate):
        return f"a {type(said).__name__} is not an Estimate"
    pose, covariance, particles = said.base_in_map, np.asarray(said.covariance), np.asarray(said.particles)
    if not all(map(math.isfinite, (pose.x, pose.y, pose.theta))):
        return "its pose is not finite"
    if covariance.shape != (3, 3) or not np.isfinite(covariance).all() or (covariance.diagonal() < 0.0).any():
        return "the covariance is not a (3, 3) array of finite numbers with variances of 0 or more"
    if particles.ndim != 2 or particles.shape[1] != 3 or not np.isfinite(particles).all():
        return "the particles are not an (n, 3) array of finite numbers"
    for name, share in (("agreement", said.agreement), ("p_wrong", said.p_wrong)):
        if share is not None and not 0.0 <= share <= 1.0:
            return f"{name} is {share}, but must be from 0 to 1, or None"
    return ""


def installed_parts(robots: Iterable[RobotParameters], call: PartCaller | None = None) -> InstalledParts:
    """Return the parts that robots' parameters name as plug-ins.

    Args:
        robots: parameters of the robots' software.
        call: function that calls labs' programs in a trial, where failures are not logged. If None, they are called
            directly.

    Raises:
        BadFile: a part is not installed, or cannot be built.
    """
    found: dict[PartKind, dict[str, Any]] = {kind: {} for kind in PART_KINDS}  # type: ignore[explicit-any]  # of labs
    for kind, name in sorted({(kind, name) for robot in robots for kind, _, name in installed_names(robot)}):
        what = f"{PART_KINDS[kind].what} {name}"
        guard = PartGuard(what, _ignore if call else FaultLog(f"the {what} failed"), call or _called)
        found[kind][name] = _GUARDED[kind](load_part(kind, name), guard)
    return InstalledParts(**found)


def load_part(kind: PartKind, name: str) -> Callable[..., Any]:  # type: ignore[explicit-any]  # of labs
    """Return the factory of a part. Raises BadFile: the part is not installed or cannot be built."""
    plugin = PART_KINDS[kind]
    factory = plugin.load(name)
    match kind:
        case "localizers":
            mount = mount_of(LaserParameters())
            takes = "a robot's parameters, a map, a laser's mount and a seed"
            plugin.made(name, lambda: factory(RobotParameters(), _hall(), mount, 0), LOCALIZER_METHODS, takes)
        case "planners":
            plugin.made(name, lambda: factory(RobotParameters(), 0), ("plan",), "a robot's parameters and a seed")
        case "recoveries":
            plugin.made(name, lambda: factory(0), ("command",), "a seed")
    return factory


LOCALIZER_METHODS = ("update", "start", "globalize", "widen", "request_update", "configure")
_GUARDED: Mapping[PartKind, Callable[..., Any]] = {  # type: ignore[explicit-any]  # of labs
    "localizers": GuardedLocalizerFactory,
    "planners": GuardedPlannerFactory,
    "recoveries": GuardedRecoveryFactory,
}


def _hall() -> OccupancyGrid:
    """Return a map of a hall that is surrounded by walls."""
    cells = np.full((80, 160), FREE, np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = OCCUPIED
    return OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0))


def _called(asked: Callable[[], T]) -> T:
    return asked()


def _ignore(_fault: str) -> None:
    pass
