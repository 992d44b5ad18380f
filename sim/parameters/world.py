"""Truth about bodies, motors and sensors."""

from dataclasses import dataclass

from sim.parameters.declaration import live, param


@dataclass(frozen=True, slots=True)
class OdometryNoise:
    """Errors of the wheels: random ones, anew every tick (Probabilistic Robotics, table 5.6), and wrong scales."""

    alpha1: float = live(0.02, "error in turning per turning", minimum=0, maximum=10)
    alpha2: float = live(0.02, "error in turning per metre driven", minimum=0, maximum=10)
    alpha3: float = live(0.02, "error in distance per metre driven", minimum=0, maximum=10)
    alpha4: float = live(0.02, "error in distance per turning", minimum=0, maximum=10)
    linear_scale: float = live(1.0, "the wheels report every distance times this", minimum=0.1, maximum=10)
    angular_scale: float = live(1.0, "the wheels report every turn times this", minimum=0.1, maximum=10)


@dataclass(frozen=True, slots=True)
class LaserParameters:
    """The laser every robot carries, and how it errs."""

    beams: int = param(181, "number of beams", minimum=2, maximum=4000)
    field_of_view: float = param(4.71238898, "angle between the first and the last beam", "rad", 0.01, 6.2831853)
    range_min: float = param(0.05, "nearest distance it can measure", "m", 0, 10)
    range_max: float = param(8.0, "farthest distance it can measure", "m", 0.1, 100)
    x: float = param(0.1, "where it sits, forward of the robot's centre", "m", -2, 2)
    rate: int = param(10, "sweeps per second; must divide 50", "Hz", 1, 50)
    range_noise: float = live(0.02, "standard deviation of a range", "m", 0, 5)
    range_bias: float = live(0.0, "what every range is too long by", "m", -1, 1)
    dropout: float = live(0.005, "share of beams that return nothing", "", 0, 1)


@dataclass(frozen=True, slots=True)
class WorldParameters:
    """Truth about the robots and their sensors, whatever their software believes."""

    footprint: tuple[tuple[float, float], ...] = param(
        ((0.25, 0.25), (-0.25, 0.25), (-0.25, -0.25), (0.25, -0.25), (0.35, 0.0)), "corners of the body", "m"
    )
    max_vel_x: float = param(1.0, "speed the motors reach", "m/s", 0.01, 20)
    max_vel_theta: float = param(1.5, "rate of turn the motors reach", "rad/s", 0.01, 20)
    acc_lim_x: float = param(10.0, "acceleration of the motors", "m/s^2", 0.01, 100)
    acc_lim_theta: float = param(10.0, "angular acceleration of the motors", "rad/s^2", 0.01, 100)
    gyro_noise: float = live(0.01, "standard deviation of the measured rate of turn", "rad/s", 0, 10)
    odometry: OdometryNoise = param(OdometryNoise(), "noise of the wheels")
    laser: LaserParameters = param(LaserParameters(), "the laser")
