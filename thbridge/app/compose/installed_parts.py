"""Parts of robots' software that studies name as plug-ins, loaded and guarded."""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Protocol, TypeVar

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import FREE, OCCUPIED, OccupancyGrid
from sim.common.observations import Imu, LaserMount, Odometry, Scan, Twist
from sim.numerics.elementary import wrap_angle
from sim.numerics.float_array import FloatArray
from sim.parameters import LaserParameters, RobotParameters
from sim.robot.installed_parts import InstalledParts, PartKind, installed_names
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
    """Function that calls a lab's program, and returns what it returns."""

    def __call__(self, asked: Callable[[], T], /) -> T:
        """Call it."""
        ...


@dataclass(frozen=True, slots=True)
class PartGuard:
    """Guard of a part: whatever the lab's program raises becomes `PartFailed`, and is logged once.

    Attributes:
        what: kind and name of the part.
        log: takes each failure.
        run: calls the lab's program; in a trial, it may take so long and no longer.
    """

    what: str
    log: Callable[[str], None]
    run: PartCaller

    def call(self, asked: Callable[[], T], wrong: Callable[[object], str] = lambda _: "") -> T:
        """Return what a call returns.

        Args:
            asked: calls the lab's program.
            wrong: says what is wrong with what was returned; empty: nothing.

        Raises:
            PartFailed: it raised an error, or what it returned is wrong.
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
        """Return the failure of the part for a problem."""
        self.log(problem)
        return PartFailed(f"the {self.what} failed: {problem}")


@dataclass(frozen=True, slots=True)
class GuardedRecoveryFactory:
    """Factory of a lab's recovery behavior; see `RecoveryFactory`.

    Attributes:
        factory: of the lab.
        guard: of what it makes.
    """

    factory: RecoveryFactory
    guard: PartGuard

    def __call__(self, seed: int, /) -> RunningRecovery:
        """Return the behavior."""
        return GuardedRecovery(self.guard.call(lambda: self.factory(seed)), self.guard)


@dataclass(frozen=True, slots=True)
class GuardedRecovery:
    """Recovery behavior of a lab.

    Attributes:
        behavior: of the lab.
        guard: of its calls.
    """

    behavior: RunningRecovery
    guard: PartGuard

    def command(self, now: RecoverySituation) -> Twist | None:
        """Return its command; see `RunningRecovery`."""
        said = self.guard.call(lambda: self.behavior.command(now), _wrong_command)
        return None if said is None else Twist(float(said.linear), float(said.angular))


def _wrong_command(said: object) -> str:
    if said is None:
        return ""
    if not isinstance(said, Twist):
        return f"a {type(said).__name__} is no Twist, and not None"
    if not (math.isfinite(said.linear) and math.isfinite(said.angular)):
        return f"the command ({said.linear}, {said.angular}) is not finite"
    return ""


@dataclass(frozen=True, slots=True)
class GuardedLocalizerFactory:
    """Factory of a lab's localizer; see `LocalizerFactory`.

    Attributes:
        factory: of the lab.
        guard: of what it makes.
    """

    factory: LocalizerFactory
    guard: PartGuard

    def __call__(self, parameters: RobotParameters, grid: OccupancyGrid, mount: LaserMount, seed: int, /) -> Localizer:
        """Return the localizer."""
        return GuardedLocalizer(lambda: self.factory(parameters, grid, mount, seed), self.guard)


class GuardedLocalizer:
    """Localizer of a lab. Where it fails, the robot is lost, and odometry carries its last estimate on.

    Args:
        make: makes the lab's localizer.
        guard: of its calls.
    """

    def __init__(self, make: Callable[[], Localizer], guard: PartGuard) -> None:
        self._guard = guard
        self._localizer: Localizer | None = None
        self._covariance = read_only(np.zeros((3, 3)))
        self._odom_in_map = Pose2(0.0, 0.0, 0.0)
        # Pose at which odometry is to be found next, when it was set and not measured.
        self._base_in_map: Pose2 | None = None
        self._fault = ""
        try:
            self._localizer = guard.call(make)
        except PartFailed as failed:
            self._fault = str(failed)

    def start(self, base_in_map: Pose2, covariance: FloatArray) -> None:
        """Begin at a pose; see `Localizer`."""
        self._base_in_map, self._covariance = base_in_map, read_only(covariance.copy())
        self._tell(lambda localizer: localizer.start(base_in_map, covariance.copy()))

    def globalize(self) -> None:
        """Forget the pose; see `Localizer`."""
        self._tell(lambda localizer: localizer.globalize())

    def widen(self, distance: float, turn: float) -> None:
        """Doubt the pose; see `Localizer`."""
        self._tell(lambda localizer: localizer.widen(distance, turn))

    def request_update(self) -> None:
        """Weigh the next scan; see `Localizer`."""
        self._tell(lambda localizer: localizer.request_update())

    def configure(self, parameters: RobotParameters) -> None:
        """Go on with parameters; see `Localizer`."""
        self._tell(lambda localizer: localizer.configure(parameters))

    def _tell(self, tell: Callable[[Localizer], None]) -> None:
        """Pass a request on; where it fails, the next update tells of it."""
        localizer = self._localizer
        if localizer is not None:
            try:
                self._guard.call(lambda: tell(localizer))
            except PartFailed as failed:
                self._fault = str(failed)

    @property
    def awaits_scan(self) -> bool:
        """False: what happens in a tick without a scan is the lab's."""
        return False

    def update(self, odometry: Odometry, imu: Imu, scan: Scan | None) -> Estimate:
        """Return its estimate, or a lost one; see `Localizer`."""
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
        # Without a localizer it stays so.
        fault, self._fault = self._fault, self._fault if self._localizer is None else ""
        return Estimate(
            odometry.tick, base_in_map, self._odom_in_map, self._covariance, _NO_PARTICLES, False, True, fault=fault
        )

    def _accepted(self, said: Estimate, odometry: Odometry) -> Estimate:
        """Return an estimate, with arrays of its own and the correction that belongs to its pose."""
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


_NO_PARTICLES = read_only(np.empty((0, 3)))


def _wrong_estimate(said: object) -> str:
    if not isinstance(said, Estimate):
        return f"a {type(said).__name__} is no Estimate"
    pose, covariance, particles = said.base_in_map, np.asarray(said.covariance), np.asarray(said.particles)
    if not all(map(math.isfinite, (pose.x, pose.y, pose.theta))):
        return "its pose is not finite"
    if covariance.shape != (3, 3) or not np.isfinite(covariance).all() or (covariance.diagonal() < 0.0).any():
        return "the covariance is no (3, 3) array of finite numbers with variances of at least 0"
    if particles.ndim != 2 or particles.shape[1] != 3 or not np.isfinite(particles).all():
        return "the particles are no (n, 3) array of finite numbers"
    for name, share in (("agreement", said.agreement), ("p_wrong", said.p_wrong)):
        if share is not None and not 0.0 <= share <= 1.0:
            return f"{name} is {share}, and has to be from 0 to 1, or None"
    return ""


def installed_parts(robots: Iterable[RobotParameters], call: PartCaller | None = None) -> InstalledParts:
    """Return the parts that robots' parameters name as plug-ins.

    Args:
        robots: parameters of the robots' software.
        call: calls labs' programs in a trial, in which no failure is logged; None: they are called as they are.

    Raises:
        BadFile: one is not installed, or cannot be made.
    """
    found: dict[PartKind, dict[str, Any]] = {kind: {} for kind in PART_KINDS}  # type: ignore[explicit-any]  # of labs
    for kind, name in sorted({(kind, name) for robot in robots for kind, _, name in installed_names(robot)}):
        what = f"{PART_KINDS[kind].what} {name}"
        guard = PartGuard(what, _ignore if call else FaultLog(f"the {what} failed"), call or _called)
        found[kind][name] = _GUARDED[kind](load_part(kind, name), guard)
    return InstalledParts(**found)


def load_part(kind: PartKind, name: str) -> Callable[..., Any]:  # type: ignore[explicit-any]  # of labs
    """Return the factory of a part. Raises BadFile: it is not installed, or cannot be made."""
    plugin = PART_KINDS[kind]
    factory = plugin.load(name)
    match kind:
        case "localizers":
            mount = mount_of(LaserParameters())
            takes = "a robot's parameters, a map, a laser's mount and a seed"
            plugin.made(name, lambda: factory(RobotParameters(), _hall(), mount, 0), LOCALIZER_METHODS, takes)
        case "recoveries":
            plugin.made(name, lambda: factory(0), ("command",), "a seed")
    return factory


LOCALIZER_METHODS = ("update", "start", "globalize", "widen", "request_update", "configure")
_GUARDED: Mapping[PartKind, Callable[..., Any]] = {  # type: ignore[explicit-any]  # of labs
    "localizers": GuardedLocalizerFactory,
    "recoveries": GuardedRecoveryFactory,
}


def _hall() -> OccupancyGrid:
    """Return a map of a hall with walls around."""
    cells = np.full((80, 160), FREE, np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = OCCUPIED
    return OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0))


def _called(asked: Callable[[], T]) -> T:
    return asked()


def _ignore(_fault: str) -> None:
    pass
