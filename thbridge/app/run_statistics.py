"""Figures of each robot for a complete run: errors of the pose, losses, distance and waiting times."""

import math
from dataclasses import dataclass

from sim.common.observations import TICK
from sim.common.robot_numbers import number_of
from sim.numerics import elementary
from sim.numerics.elementary import wrap_angle
from sim.snapshot import TeamSnapshot


@dataclass(frozen=True, slots=True)
class RobotStatistics:
    """Figures of one robot.

    Errors are differences between the believed pose and the true pose at scans; they are None if there was no scan.

    Attributes:
        robot: number of the robot, from 1.
        position_rmse: root mean square of the position errors, meters.
        position_max: largest position error, meters.
        heading_rmse: root mean square of the heading errors, degrees.
        heading_max: largest heading error, degrees.
        times_lost: number of times that the localizer reported that the robot was lost.
        seconds_lost: total simulated time for which the robot was lost, seconds.
        distance: distance driven, meters.
        seconds_waiting: total simulated time in which the robot waited for another robot, seconds.
    """

    robot: int
    position_rmse: float | None
    position_max: float | None
    heading_rmse: float | None
    heading_max: float | None
    times_lost: int
    seconds_lost: float
    distance: float
    seconds_waiting: float


class _Sums:
    """Sums over the ticks of one robot."""

    def __init__(self) -> None:
        self.samples = 0
        # Of the position, meters, and of the heading, rad.
        self.squares = [0.0, 0.0]
        self.greatest = [0.0, 0.0]
        self.times_lost = self.ticks_lost = self.ticks_waiting = 0
        self.is_lost = self.waits = False
        self.distance = 0.0


class RunStatistics:
    """Sums over the ticks of a run, without the ticks in which a robot is dead."""

    def __init__(self) -> None:
        self._robots: list[_Sums] = []

    def add(self, snapshot: TeamSnapshot) -> None:
        """Add a tick of simulated robots."""
        truth = snapshot.truth
        while len(self._robots) < len(snapshot.robots):
            self._robots.append(_Sums())
        speeds = truth.twists[:, 0].tolist()
        renewed = snapshot.renewed
        for index, (sums, speed) in enumerate(zip(self._robots, speeds, strict=True)):
            if index in snapshot.dead:
                continue
            # The distance follows from the speed, because a change of position can also be a move by hand.
            sums.distance += abs(speed) * TICK
            robot = renewed.get(index)
            if robot is None:
                # The robot has no scan, and waits or is lost as at its last step.
                sums.ticks_waiting += sums.waits
                sums.ticks_lost += sums.is_lost
                continue
            lost = robot.lost
            sums.waits = robot.navigation.waits_for is not None
            sums.ticks_waiting += sums.waits
            sums.times_lost += lost and not sums.is_lost
            sums.ticks_lost += lost
            sums.is_lost = lost
            if robot.observations.scan is not None:
                x, y, theta = truth.poses[index].tolist()
                believed = robot.estimate.base_in_map
                position = elementary.hypot(believed.x - x, believed.y - y)
                heading = abs(wrap_angle(believed.theta - theta))
                sums.samples += 1
                for each, error in enumerate((position, heading)):
                    sums.squares[each] += error * error
                    sums.greatest[each] = max(sums.greatest[each], error)

    def figures(self) -> tuple[RobotStatistics, ...]:
        """Return the figures so far, rounded."""
        return tuple(_figures(robot, sums) for robot, sums in enumerate(self._robots))


def _figures(robot: int, sums: _Sums) -> RobotStatistics:
    position, heading = (math.sqrt(each / sums.samples) for each in sums.squares) if sums.samples else (None, None)
    farthest, most = sums.greatest if sums.samples else (None, None)
    return RobotStatistics(
        robot=number_of(robot),
        position_rmse=_rounded(position, 4),
        position_max=_rounded(farthest, 4),
        heading_rmse=_rounded(heading, 3, degrees=True),
        heading_max=_rounded(most, 3, degrees=True),
        times_lost=sums.times_lost,
        seconds_lost=round(sums.ticks_lost * TICK, 2),
        distance=round(sums.distance, 3),
        seconds_waiting=round(sums.ticks_waiting * TICK, 2),
    )


def _rounded(value: float | None, digits: int, *, degrees: bool = False) -> float | None:
    return None if value is None else round(math.degrees(value) if degrees else float(value), digits)
