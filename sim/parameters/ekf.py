"""Kalman filter localization."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import live, param


@dataclass(frozen=True, slots=True)
class EkfParameters:
    """Extended Kalman filter localization: odometry and gyroscope, corrected by matching scans to the map.

    It stands where robot_pose_ekf stood, and takes its names: the matched pose is its visual odometry.

    Differs: nothing of robot_pose_ekf may change while it runs.
    """

    ros_only: ClassVar[Mapping[str, str]] = {
        "freq": "how often estimates are published; here there is one every tick",
        "sensor_timeout": "how long to wait for a sensor that fell silent; sensors do not, here",
        "odom_used": "whether the wheels are listened to; here they always are",
        "gps_used": "whether GPS is listened to; there is none indoors",
        "debug": "whether the filter writes files about itself",
        "self_diagnose": "whether the filter checks its sensors' time stamps",
        "output_frame": "the name of the estimate's frame in tf",
        "base_footprint_frame": "the name of the robot's frame in tf",
    }

    imu_used: bool = param(True, "whether the gyroscope is listened to")
    vo_used: bool = param(True, "whether scans are matched to the map; without, doubt only grows")
    update_min_d: float = live(0.2, "metres to drive before a scan is matched", "m", 0, 5)
    update_min_a: float = live(0.523599, "angle to turn before a scan is matched", "rad", 0, 6.2832)
    initial_cov_xx: float = param(0.25, "variance of the first pose", "m^2", 0)
    initial_cov_yy: float = param(0.25, "variance of the first pose", "m^2", 0)
    initial_cov_aa: float = param(0.06853891945200942, "variance of the first heading", "rad^2", 0)
    laser_max_beams: int = live(60, "beams of a scan that are matched", "", 2, 4000)
    laser_max_range: float = live(-1.0, "farther readings are not used; -1: the laser's own limit", "m", -1)
    odom_alpha1: float = live(0.01, "believed variance in turning per turning", "", 0, 10)
    odom_alpha2: float = live(0.01, "believed variance in turning per metre", "", 0, 10)
    odom_alpha3: float = live(0.01, "believed variance in distance per metre", "", 0, 10)
    odom_alpha4: float = live(0.01, "believed variance in distance per turning", "", 0, 10)
    gyro_noise: float = live(0.01, "believed standard deviation of the measured rate of turn", "rad/s", 0, 10)


@dataclass(frozen=True, slots=True)
class UkfParameters:
    """Unscented Kalman filter localization: sigma points; all else is as in `ekf`.

    Names and defaults are those of robot_localization's ukf_localization_node.
    """

    alpha: float = param(0.001, "spread of the sigma points about the mean", "", 0.0001, 1)
    beta: float = param(2.0, "knowledge of the distribution; 2 is best for a Gaussian", "", 0, 10)
    kappa: float = param(0.0, "second parameter of the spread", "", 0, 10)
