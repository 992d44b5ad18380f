"""The software of one robot: sense -> estimate -> plan -> drive."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

from sim.common.geometry import Pose2
from sim.common.observations import Neighbour, Observations, Scan, Twist
from sim.numerics import elementary
from sim.numerics.float_array import FloatArray
from sim.parameters import RobotParameters
from sim.robot.costmap.footprint_cost import circumscribed_radius
from sim.robot.localization.estimate import Estimate, Localizer
from sim.robot.navigator.move_base import Navigator
from sim.robot.navigator.navigation import Navigation


@dataclass(frozen=True)
class RobotOutput:
    """Output of one robot's software in one tick.

    Attributes:
        observations: messages of the robot's sensors.
        estimate: the robot's pose estimate.
        navigation: command, goal and plan. The command takes effect in the next tick.
        neighbour: state that the robot broadcasts. The other robots receive it in the next tick.
    """

    observations: Observations
    estimate: Estimate
    navigation: Navigation
    neighbour: Neighbour

    @property
    def tick(self) -> int:
        """Tick of the observations."""
        return self.observations.tick

    @property
    def lost(self) -> bool:
        """True if the robot considers itself lost."""
        return self.estimate.lost


class LazyOutput(RobotOutput):
    """Output that follows from the output of the last step and from odometry.

    Its attributes are computed only when they are read, because most ticks are never examined.
    """

    _parts: tuple[RobotOutput, int, Sequence[float], Sequence[float], Callable[[], Observations]]

    @classmethod
    def of(
        cls,
        left: RobotOutput,
        tick: int,
        base_in_map: Sequence[float],
        twist: Sequence[float],
        sense: Callable[[], Observations],
    ) -> Self:
        """Propagate an output.

        Args:
            left: output of the last step, without data that are valid only in the tick of that step.
            tick: the present tick.
            base_in_map: x, y and heading of the robot's present pose estimate.
            twist: velocity of the robot by odometry, m/s and rad/s.
            sense: function that returns the robot's present observations.
        """
        output = cls.__new__(cls)
        output.__dict__.update(navigation=left.navigation, _parts=(left, tick, base_in_map, twist, sense))
        return output

    @property
    def tick(self) -> int:
        """The same as in `RobotOutput`. No other attribute is computed for it."""
        return self._parts[1]

    @property
    def lost(self) -> bool:
        """The same as in `RobotOutput`. No other attribute is computed for it."""
        return self._parts[0].lost

    @cached_property
    def observations(self) -> Observations:
        """Observations, computed at the first use."""
        return self._parts[-1]()

    @cached_property
    def estimate(self) -> Estimate:
        """Estimate, computed at the first use."""
        left, tick, _, _, _ = self._parts
        return replace(left.estimate, tick=tick, base_in_map=self.neighbour.base_in_map, updated=False, fault="")

    @cached_property
    def neighbour(self) -> Neighbour:
        """State that the robot broadcasts, computed at the first use."""
        left, _, (x, y, theta), (linear, angular), _ = self._parts
        last, here, twist = left.neighbour, Pose2(x, y, theta), Twist(linear, angular)
        return Neighbour(last.robot, here, twist, last.footprint, last.path, last.times, last.claim)


class PropagatedOutput(LazyOutput):
    """Output in a tick without a step."""


class RestingOutput(LazyOutput):
    """Output in a tick in which a resting robot only marked and cleared obstacles with a scan."""

    @cached_property
    def estimate(self) -> Estimate:
        """Estimate, computed at the first use. Its correction is a new object, as after every scan."""
        estimate = super().estimate
        return replace(estimate, odom_in_map=replace(estimate.odom_in_map))


class Robot:
    """The software of one robot: a localizer connected to a navigator. Its only inputs are observations and messages.

    Args:
        index: index of the robot in the team.
        footprint: (n, 2) corners of the robot's body in the base frame, meters.

    Attributes:
        next_due: next tick in which a step is needed even without a scan or a request. Before it, the last output is
            propagated.
        lost: True if the robot was lost in the last step.
        rests: True if, until `next_due`, scans only mark and clear obstacles, unless the robot moves.
        lasting: output of the last step, without data that are valid only in its tick. None before the first step.
    """

    def __init__(self, index: int, localizer: Localizer, navigator: Navigator, footprint: FloatArray) -> None:
        self.index = index
        self.localizer = localizer
        self.navigator = navigator
        self._footprint = footprint
        self._radius = circumscribed_radius(footprint)
        self.next_due = 0
        self.lost = False
        self.rests = False
        self._base_in_odom: Sequence[float] = ()
        self.lasting: RobotOutput | None = None
        # Ticks of the last step, and of the last tick that is known to have had no step.
        self._stepped = self._passed = -1

    def configure(self, parameters: RobotParameters) -> None:
        """Continue with these parameters. Pose estimate, costmaps and goal do not change."""
        self.localizer.configure(parameters)
        self.navigator.configure(parameters)

    def step(self, observations: Observations, neighbours: Sequence[Neighbour]) -> RobotOutput:
        """Run one tick: estimate from the observations, then plan and choose the next command.

        Args:
            observations: observations of this tick.
            neighbours: broadcasts of the other robots in the last tick.
        """
        tick, odometry = observations.tick, observations.odometry
        estimate = self.localizer.update(odometry, observations.imu, observations.scan)
        navigation = self.navigator.step(
            tick, estimate.base_in_map, odometry.twist, observations.scan, neighbours, estimate.lost
        )
        neighbour = Neighbour(
            self.index,
            estimate.base_in_map,
            odometry.twist,
            self._footprint,
            navigation.plan[:, :2],
            navigation.times,
            navigation.claim,
        )
        output = self.lasting = RobotOutput(observations, estimate, navigation, neighbour)
        base = odometry.base_in_odom
        self.lost, self._stepped, self._base_in_odom = estimate.lost, tick, [base.x, base.y, base.theta]
        carries = self.localizer.awaits_scan and not estimate.lost
        self.next_due = self.navigator.next_due(tick, neighbours) if carries else tick + 1
        self.rests = carries and self.navigator.rests and self.localizer.ignores_scans(odometry)
        if navigation.result or navigation.global_costmap or navigation.local_costmap or navigation.fault:
            lasting = replace(navigation, result=None, global_costmap=None, local_costmap=None, fault="")
            self.lasting = RobotOutput(observations, estimate, lasting, neighbour)
        return output

    def is_at_rest(self, tick: int, base_in_odom: Sequence[float]) -> bool:
        """Return True if `take_in` is enough for a scan in this tick.

        Args:
            tick: the present tick.
            base_in_odom: present pose by odometry.
        """
        return self.rests and tick < self.next_due and base_in_odom == self._base_in_odom

    def take_in(self, scan: Scan, near: Callable[[int, Pose2, float], Sequence[Neighbour]]) -> None:
        """Mark and clear obstacles with a scan while the robot rests. The output does not change.

        Args:
            scan: the scan.
            near: function that returns at least the broadcasts within a distance of a pose, see `Team`.
        """
        if self.lasting is not None:
            base_in_map, laser = self.lasting.estimate.base_in_map, scan.mount.laser_in_base
            reach = self.navigator.explained_range + self._radius + elementary.hypot(laser.x, laser.y)
            # The navigator selects exactly, also on a rotated map.
            self.navigator.take_in(base_in_map, scan, near(self.index, base_in_map, 1.5 * reach + 0.1))

    def pass_to(self, tick: int) -> None:
        """Record that there was no step since the last step, until and including this tick."""
        if -1 < self._stepped < tick:
            self._passed = tick
            self.navigator.skip(tick)

    def rejoin(self, neighbours: Sequence[Neighbour]) -> None:
        """Process the broadcasts that came before the last tick, if this robot had no step in that tick."""
        if self._passed > self._stepped:
            self.navigator.rejoin(neighbours)
