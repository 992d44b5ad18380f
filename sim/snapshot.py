"""Snapshot of a team in one tick, for the game, recordings and windows."""

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from typing import Self, overload

from sim.common.frozen import frozen
from sim.common.observations import Observations, Scan
from sim.numerics.float_array import FloatArray
from sim.robot.localization.estimate import propagated
from sim.robot.software import PropagatedOutput, RestingOutput, RobotOutput
from sim.world.physics import WorldState


class TeamOutputs(Sequence[RobotOutput]):
    """Outputs of all robots in one tick. Outputs of robots without a step are made when they are read.

    Args:
        stepped: outputs of the robots with a step, by index.
        lasting: last outputs of all robots, without data that are valid only in the tick of their step.
        dead: indices of the dead robots. Their last outputs are repeated.
        scans: scans that resting robots took in, by index.
        state: the present world.
        corrections: (n, 3) poses of odom in the map, as estimated by each robot.
        sense: function that returns the observations of a robot.
    """

    def __init__(
        self,
        stepped: Mapping[int, RobotOutput],
        lasting: Sequence[RobotOutput],
        dead: frozenset[int],
        scans: Mapping[int, Scan],
        state: WorldState,
        corrections: FloatArray,
        sense: Callable[[WorldState, int, Scan | None], Observations],
    ) -> None:
        self._stepped = stepped
        self._known = dict(stepped)
        self._lasting = lasting
        self._dead = dead
        self._scans = scans
        self._state = state
        self._corrections = corrections
        self._sense = sense

    def __len__(self) -> int:
        return len(self._lasting)

    @overload
    def __getitem__(self, index: int) -> RobotOutput: ...
    @overload
    def __getitem__(self, index: "slice[int | None, int | None, int | None]") -> Sequence[RobotOutput]: ...
    def __getitem__(
        self, index: "int | slice[int | None, int | None, int | None]"
    ) -> RobotOutput | Sequence[RobotOutput]:
        if isinstance(index, slice):
            return [self[each] for each in range(len(self))[index]]
        output = self._known.get(index)
        return self._make(range(len(self))[index]) if output is None else output

    def _make(self, robot: int) -> RobotOutput:
        if robot in self._dead:
            return self._lasting[robot]
        scan = self._scans.get(robot)
        kind = PropagatedOutput if scan is None else RestingOutput
        believed, twists = self._moved
        sense = partial(self._sense, self._state, robot, scan)
        output = self._known[robot] = kind.of(
            self._lasting[robot], self._state.tick, believed[robot], twists[robot], sense
        )
        return output

    @cached_property
    def believed(self) -> FloatArray:
        """(n, 3) pose estimates of all robots, by their last corrections and odometry."""
        return propagated(self._corrections, self._state.odom_poses)

    @cached_property
    def renewed(self) -> Mapping[int, RobotOutput]:
        """Outputs of robots with a step or a scan in this tick; see `TeamSnapshot.renewed`."""
        if not self._scans:
            return self._stepped
        return {robot: self[robot] for robot in sorted({*self._stepped, *self._scans})}

    @cached_property
    def _moved(self) -> tuple[list[list[float]], list[list[float]]]:
        """Pose estimates and measured velocities of all robots."""
        return self.believed.tolist(), self._state.odom_twists.tolist()


@frozen()
class TeamSnapshot:
    """State of a team in one tick: truth, observations, beliefs and commands.

    Attributes:
        tick: the present tick.
        world: the truth. Robots never get it, and people get it only if the study permits this. None for real robots,
            because their truth is unknown.
        robots: outputs of the robots, in the team's order.
        commands: (n, 2) m/s and rad/s given to the motors in this tick, by navigators or by hand.
        dead: indices of dead robots. They perceive nothing, broadcast nothing and do nothing. Their entries are
            from the last tick before their death.
    """

    tick: int
    world: WorldState | None
    robots: Sequence[RobotOutput]
    commands: FloatArray
    dead: frozenset[int] = frozenset()

    @property
    def truth(self) -> WorldState:
        """The truth about simulated robots.

        Raises:
            ValueError: these are real robots.
        """
        if self.world is None:
            raise ValueError("the true state of real robots is unknown")
        return self.world

    @property
    def renewed(self) -> Mapping[int, RobotOutput]:
        """Outputs of this tick by robot, in the team's order, without propagated and repeated outputs."""
        outputs = self.robots
        return outputs.renewed if isinstance(outputs, TeamOutputs) else dict(enumerate(outputs))

    def read_costmaps(self) -> Self:
        """Read all costmaps of this tick, so that they can still be read after the next step. Return this snapshot."""
        for output in self.renewed.values():
            for shown in (output.navigation.global_costmap, output.navigation.local_costmap):
                if shown is not None:
                    shown.read()
        return self
