"""True noise of every robot's sensors. It may change while robots run.

Random numbers of keyed noise (`sim.numerics.noise`) are multiplied by these values. So a change for one robot does not
change the random numbers of another robot.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sim.numerics.float_array import FloatArray
from sim.numerics.kernels import njit
from sim.parameters import OdometryNoise, WorldParameters


class WheelNoise(NamedTuple):
    """Noise of the wheels, as in OdometryNoise, in the form for compiled kernels."""

    alpha1: float
    alpha2: float
    alpha3: float
    alpha4: float
    linear_scale: float
    angular_scale: float


def wheel_noise_of(noise: OdometryNoise) -> WheelNoise:
    """Convert the parameters to the form for compiled kernels."""
    return WheelNoise(noise.alpha1, noise.alpha2, noise.alpha3, noise.alpha4, noise.linear_scale, noise.angular_scale)


@njit(cache=True)
def measured_increment(wheels: WheelNoise, chord: float, half: float, draws: FloatArray) -> tuple[float, float, float]:
    """Return the arc of one tick as measured by the wheels: first turn, length of the chord, second turn.

    Args:
        wheels: noise of the wheels.
        chord: signed length of the true chord, meters.
        half: angle from the heading before the tick to the chord, which is half of the true turn, radians.
        draws: (3,) standard normals.

    Source: Probabilistic Robotics, table 5.6, applied to the true increment.
    """
    turn_noise = math.sqrt(wheels.alpha1 * half * half + wheels.alpha2 * chord * chord)
    chord_noise = math.sqrt(wheels.alpha3 * chord * chord + 2.0 * wheels.alpha4 * half * half)
    first_turn = wheels.angular_scale * (half + turn_noise * draws[0])
    measured_chord = wheels.linear_scale * (chord + chord_noise * draws[1])
    second_turn = wheels.angular_scale * (half + turn_noise * draws[2])
    return first_turn, measured_chord, second_turn


@dataclass(frozen=True, slots=True, eq=False)
class SensorNoise:
    """True noise of the sensors of n robots. Its arrays are read-only.

    Attributes:
        wheels: (n, 6) values of a `WheelNoise` in each row.
        laser: (n, 3) standard deviation and bias of ranges, meters, and proportion of lost beams.
        gyro: (n,) standard deviation of the measured angular velocity, rad/s.
    """

    wheels: FloatArray
    laser: FloatArray
    gyro: FloatArray

    def __post_init__(self) -> None:
        """Make the arrays read-only."""
        self.wheels.flags.writeable = False
        self.laser.flags.writeable = False
        self.gyro.flags.writeable = False

    @classmethod
    def of(cls, robots: Sequence[WorldParameters]) -> "SensorNoise":
        """Collect the noise of a team, from each robot's parameters."""
        wheels = [wheel_noise_of(robot.odometry) for robot in robots]
        lasers = [(robot.laser.range_noise, robot.laser.range_bias, robot.laser.dropout) for robot in robots]
        return cls(
            np.array(wheels, dtype=np.float64).reshape(-1, 6),
            np.array(lasers, dtype=np.float64).reshape(-1, 3),
            np.array([robot.gyro_noise for robot in robots], dtype=np.float64),
        )
