"""N robots in one world, and the one order of doing things."""

from dataclasses import dataclass

from sim.robot import RobotOutput
from sim.world import WorldState


@dataclass(frozen=True, slots=True)
class TeamSnapshot:
    """Everything that is true, perceived, believed and done in one tick.

    Attributes:
        tick: which one.
        world: the truth; not for robots, and for people only where the study says so.
        robots: one entry a robot, in the team's order.
    """

    tick: int
    world: WorldState
    robots: tuple[RobotOutput, ...]
