"""Interface of SimR's team of robots, which are simulated (`sim.team.Team`) or real."""

from collections.abc import Sequence
from typing import Protocol

from sim.inputs import TeamInput
from sim.parameters import RobotParameters, WorldParameters
from sim.snapshot import TeamSnapshot


class RobotTeam(Protocol):
    """A team of robots."""

    @property
    def size(self) -> int:
        """Number of robots."""

    @property
    def parameters(self) -> tuple[RobotParameters, ...]:
        """Current parameters of each robot's software; empty for real robots."""

    @property
    def worlds(self) -> tuple[WorldParameters, ...]:
        """Current true properties of each robot's body, motors and sensors; empty if `parameters` is empty."""

    def step(self, inputs: Sequence[TeamInput] = ()) -> TeamSnapshot:
        """Run one tick with these inputs, in order. Inputs that a robot cannot carry out have no effect."""
