"""Parameters of Kalman filter localization."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from sim.parameters.declaration import live, param


@dataclass(frozen=True, slots=True)
class EkfParameters:
    """Extended Kalman filter localization: odometry and gyroscope, corrected by matching scans to the map.

    It replaces robot_pose_ekf and accepts its parameter names. The pose from scan matching takes the role of visual
    odometry.

    Difference from ROS: robot_pose_ekf cannot change parameters while it runs.
    """

    ros_only: ClassVar[Mapping[str, str]] = {
        "freq": "publishing rate of estimates; here one estimate in each tick",
        "sensor_timeout": "time to wait for a silent sensor; here sensors never fall silent",
        "odom_used": "use wheel odometry; here it is always used",
        "gps_used": "use GPS, which these robots do not have",
        "debug": "write debug files",
        "self_diagnose": "check the time stamps of the sensors",
        "output_frame": "name of the frame of the estimate in tf",
        "base_footprint_frame": "name of the robot frame in tf",
    }

    imu_used: bool = param(True, "use the gyroscope")
    vo_used: bool = param(True, "match scans to the map; if false, the covariance only grows")
    update_min_d: float = live(0.2, "distance driven before the next scan is matched", "m", 0, 5)
    update_min_a: float = live(0.523599, "angle turned before the next scan is matched", "rad", 0, 6.2832)
    initial_cov_xx: float = param(0.25, "initial variance of x", "m^2", 0)
    initial_cov_yy: float = param(0.25, "initial variance of y", "m^2", 0)
    initial_cov_aa: float = param(0.06853891945200942, "initial variance of the heading", "rad^2", 0)
    laser_max_beams: int = live(60, "number of beams of a scan that are matched", "", 2, 4000)
    laser_max_range: float = live(-1.0, "ignore readings farther than this; -1: use the laser's maximum range", "m", -1)
    odom_alpha1: float = live(0.01, "expected variance of measured rotation due to rotation", "", 0, 10)
    odom_alpha2: float = live(0.01, "expected variance of measured rotation due to driving", "", 0, 10)
    odom_alpha3: float = live(0.01, "expected variance of measured distance due to driving", "", 0, 10)
    odom_alpha4: float = live(0.01, "expected variance of measured distance due to rotation", "", 0, 10)
    gyro_noise: float = live(0.01, "expected standard deviation of the measured angular velocity", "rad/s", 0, 10)


@dataclass(frozen=True, slots=True)
class UkfParameters:
    """Sigma points of the unscented Kalman filter localization. All other parameters are the same as for `ekf`.

    Names and defaults are those of robot_localization's ukf_localization_node.
    """

    alpha: float = param(0.001, "spread of the sigma points about the mean", "", 0.0001, 1)
    beta: float = param(2.0, "prior knowledge of the distribution; 2 is optimal for a Gaussian", "", 0, 10)
    kappa: float = param(0.0, "second parameter of the spread, usually 0", "", 0, 10)
