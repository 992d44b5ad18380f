"""One robot's own software: sense -> estimate -> plan -> drive."""

from dataclasses import dataclass

from sim.localization.estimate import Estimate
from sim.navigator import Navigation
from sim.observations import Neighbour, Observations


@dataclass(frozen=True, slots=True)
class RobotOutput:
    """What one robot makes of one tick.

    Attributes:
        observations: what it perceived.
        estimate: where it believes it is.
        navigation: what it does about its goal; its command acts in the next tick.
        neighbour: what it tells the other robots, which they hear in the next tick.
    """

    observations: Observations
    estimate: Estimate
    navigation: Navigation
    neighbour: Neighbour
