"""One robot's own software: sense -> estimate -> plan -> drive."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from sim.common.geometry import Pose2
from sim.common.observations import Neighbour, Observations, Twist
from sim.numerics.float_array import FloatArray
from sim.parameters import RobotParameters
from sim.robot.localization.estimate import Estimate, Localizer
from sim.robot.navigator.move_base import Navigator
from sim.robot.navigator.navigation import Navigation


@dataclass(frozen=True)
class RobotOutput:
    """Output of one robot's software in one tick.

    Attributes:
        observations: its sensors' messages.
        estimate: believed pose of the robot.
        navigation: command, goal and plan; its command acts in the next tick.
        neighbor: the state that it broadcasts; the other robots receive it in the next tick.
    """

    observations: Observations
    estimate: Estimate
    navigation: Navigation
    neighbour: Neighbour

    @property
    def tick(self) -> int:
        """The tick of its observations."""
        return self.observations.tick

    @property
    def lost(self) -> bool:
        """True when the robot holds itself to be lost."""
        return self.estimate.lost


class PropagatedOutput(RobotOutput):
    """Output in a tick in which nothing was due: that of the last step, propagated by odometry.

    Its parts are made when somebody looks at them, which in most ticks nobody does.
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
    ) -> "PropagatedOutput":
        """Propagate an output.

        Args:
            left: the output of the last step, but for what holds in its own tick alone.
            tick: the present one.
            base_in_map: x, y and heading that the robot believes in now.
            twist: its velocity by odometry, m/s and rad/s.
            sense: makes its observations of now.
        """
        output = cls.__new__(cls)
        output.__dict__.update(navigation=left.navigation, _parts=(left, tick, base_in_map, twist, sense))
        return output

    @property
    def tick(self) -> int:
        """See `RobotOutput`; nothing is made."""
        return self._parts[1]

    @property
    def lost(self) -> bool:
        """See `RobotOutput`; nothing is made."""
        return self._parts[0].lost

    @cached_property
    def observations(self) -> Observations:
        """Made now."""
        return self._parts[-1]()

    @cached_property
    def estimate(self) -> Estimate:
        """Made now."""
        left, tick, _, _, _ = self._parts
        return replace(left.estimate, tick=tick, base_in_map=self.neighbour.base_in_map, updated=False, fault="")

    @cached_property
    def neighbour(self) -> Neighbour:
        """Made now."""
        left, _, (x, y, theta), (linear, angular), _ = self._parts
        last, here, twist = left.neighbour, Pose2(x, y, theta), Twist(linear, angular)
        return Neighbour(last.robot, here, twist, last.footprint, last.path, last.times, last.claim)


class Robot:
    """The software of one robot: a localizer and a navigator, joined; it knows nothing but its observations.

    Args:
        index: its index in the team.
        footprint: (n, 2) corners of its body in the base frame, meters.

    Attributes:
        next_due: first tick in which a step does more than carry its output on, if no scan and no request comes.
        lost: True if it did not know its place in the last step.
    """

    def __init__(self, index: int, localizer: Localizer, navigator: Navigator, footprint: FloatArray) -> None:
        self.index = index
        self.localizer = localizer
        self.navigator = navigator
        self._footprint = footprint
        self.next_due = 0
        self.lost = False
        self._skipped = False
        self._left: RobotOutput

    def configure(self, parameters: RobotParameters) -> None:
        """Go on with these parameters, and with the present belief, costmaps and goal."""
        self.localizer.configure(parameters)
        self.navigator.configure(parameters)

    def step(self, observations: Observations, neighbours: Sequence[Neighbour]) -> RobotOutput:
        """Return one tick: estimate from what was sensed, then plan and choose the next command.

        Args:
            observations: this tick's.
            neighbors: broadcasts of the other robots in the last tick.
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
        output = self._left = RobotOutput(observations, estimate, navigation, neighbour)
        self.lost, self._skipped = estimate.lost, False
        carries = self.localizer.awaits_scan and not estimate.lost
        self.next_due = self.navigator.next_due(tick, neighbours) if carries else tick + 1
        if navigation.result or navigation.global_costmap or navigation.local_costmap or navigation.fault:
            lasting = replace(navigation, result=None, global_costmap=None, local_costmap=None, fault="")
            # The output, but for what holds in its own tick alone.
            self._left = RobotOutput(observations, estimate, lasting, neighbour)
        return output

    def skip(
        self, tick: int, base_in_map: Sequence[float], twist: Sequence[float], sense: Callable[[], Observations]
    ) -> RobotOutput:
        """Return one tick in which nothing is due. See `PropagatedOutput.of` for the arguments."""
        self.navigator.skip(tick)
        self._skipped = True
        return PropagatedOutput.of(self._left, tick, base_in_map, twist, sense)

    def rejoin(self, neighbours: Sequence[Neighbour]) -> None:
        """Take in what others broadcast before the last tick, if no step was due in that."""
        if self._skipped:
            self.navigator.rejoin(neighbours)
