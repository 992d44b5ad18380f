"""True properties of bodies, motors and sensors."""

from dataclasses import dataclass

from sim.parameters.declaration import live, param


@dataclass(frozen=True, slots=True)
class OdometryNoise:
    """Odometry noise: a random error in each tick (Probabilistic Robotics, table 5.6), and a constant scale error."""

    alpha1: float = live(0.02, "noise of measured rotation due to rotation", minimum=0, maximum=10)
    alpha2: float = live(0.02, "noise of measured rotation due to driving", minimum=0, maximum=10)
    alpha3: float = live(0.02, "noise of measured distance due to driving", minimum=0, maximum=10)
    alpha4: float = live(0.02, "noise of measured distance due to rotation", minimum=0, maximum=10)
    linear_scale: float = live(1.0, "reported distance divided by true distance", minimum=0.1, maximum=10)
    angular_scale: float = live(1.0, "reported rotation divided by true rotation", minimum=0.1, maximum=10)


@dataclass(frozen=True, slots=True)
class LaserParameters:
    """The laser of each robot, and its true noise."""

    beams: int = param(181, "number of beams", minimum=2, maximum=4000)
    field_of_view: float = param(4.71238898, "angle between the first and the last beam", "rad", 0.01, 6.2831853)
    range_min: float = param(0.05, "minimum range", "m", 0, 10)
    range_max: float = param(8.0, "maximum range", "m", 0.1, 100)
    x: float = param(0.1, "distance of the laser in front of the robot's center", "m", -2, 2)
    rate: int = param(10, "scan rate; must divide 50", "Hz", 1, 50)
    range_noise: float = live(0.02, "standard deviation of a range", "m", 0, 5)
    range_bias: float = live(0.0, "systematic error added to every range", "m", -1, 1)
    dropout: float = live(0.005, "proportion of beams without a reading", "", 0, 1)


@dataclass(frozen=True, slots=True)
class WorldParameters:
    """True properties of the robots and their sensors, independent of the parameters of their software."""

    footprint: tuple[tuple[float, float], ...] = param(
        ((0.25, 0.25), (-0.25, 0.25), (-0.25, -0.25), (0.25, -0.25), (0.35, 0.0)), "corners of the robot's body", "m"
    )
    max_vel_x: float = param(1.0, "maximum velocity of the motors", "m/s", 0.01, 20)
    max_vel_theta: float = param(1.5, "maximum angular velocity of the motors", "rad/s", 0.01, 20)
    acc_lim_x: float = param(10.0, "maximum acceleration of the motors", "m/s^2", 0.01, 100)
    acc_lim_theta: float = param(10.0, "maximum angular acceleration of the motors", "rad/s^2", 0.01, 100)
    gyro_noise: float = live(0.01, "standard deviation of the measured angular velocity", "rad/s", 0, 10)
    odometry: OdometryNoise = param(OdometryNoise(), "odometry noise")
    laser: LaserParameters = param(LaserParameters(), "laser")
