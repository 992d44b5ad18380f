"""The robots that SimR commands: simulated ones (`sim.team.Team`), or those of others."""

from collections.abc import Sequence
from typing import Protocol

from sim.inputs import TeamInput
from sim.parameters import RobotParameters, WorldParameters
from sim.team import TeamSnapshot


class RobotTeam(Protocol):
    """A team of robots."""

    @property
    def size(self) -> int:
        """How many robots."""

    @property
    def parameters(self) -> tuple[RobotParameters, ...]:
        """Of each robot's software, as they are now; empty where they are not ours to change."""

    @property
    def worlds(self) -> tuple[WorldParameters, ...]:
        """What is true of each robot's body, motors and sensors now; empty where `parameters` is."""

    def step(self, inputs: Sequence[TeamInput] = ()) -> TeamSnapshot:
        """One tick, with what is asked of the robots, in its order; what robots cannot do, they leave."""
