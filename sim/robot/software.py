"""One robot's own software: sense -> estimate -> plan -> drive."""

from collections.abc import Sequence
from dataclasses import dataclass

from sim.common.geometry import FloatArray
from sim.common.observations import Neighbour, Observations
from sim.parameters import RobotParameters
from sim.robot.localization.estimate import Estimate, Localizer
from sim.robot.navigator.move_base import Navigator
from sim.robot.navigator.navigation import Navigation


@dataclass(frozen=True, slots=True)
class RobotOutput:
    """Output of one robot's software in one tick.

    Attributes:
        observations: its sensors' messages.
        estimate: believed pose of the robot.
        navigation: command, goal and plan; its command acts in the next tick.
        neighbour: the state that it broadcasts; the other robots receive it in the next tick.
    """

    observations: Observations
    estimate: Estimate
    navigation: Navigation
    neighbour: Neighbour


class Robot:
    """The software of one robot: a localiser and a navigator, joined; it knows nothing but its observations.

    Args:
        index: its index in the team.
        footprint: (n, 2) corners of its body in the base frame, metres.
    """

    def __init__(self, index: int, localizer: Localizer, navigator: Navigator, footprint: FloatArray) -> None:
        self.index = index
        self.localizer = localizer
        self.navigator = navigator
        self._footprint = footprint

    def configure(self, parameters: RobotParameters) -> None:
        """Go on with these parameters, and with the present belief, costmaps and goal."""
        self.localizer.configure(parameters)
        self.navigator.configure(parameters)

    def step(self, observations: Observations, neighbours: Sequence[Neighbour]) -> RobotOutput:
        """One tick: estimate from what was sensed, then plan and choose the next command.

        Args:
            observations: this tick's.
            neighbours: broadcasts of the other robots in the last tick.
        """
        odometry = observations.odometry
        estimate = self.localizer.update(odometry, observations.imu, observations.scan)
        navigation = self.navigator.step(
            observations.tick, estimate.base_in_map, odometry.twist, observations.scan, neighbours, estimate.lost
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
        return RobotOutput(observations, estimate, navigation, neighbour)
