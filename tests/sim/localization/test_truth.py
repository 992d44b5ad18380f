import numpy as np
import pytest

from sim.geometry import Pose2
from sim.localization.truth import Truth
from sim.observations import STANDSTILL, Imu, Odometry


def test_the_truth_needs_no_telling():
    where = Pose2(1.0, 2.0, 0.5)
    truth = Truth(lambda: where)
    truth.start(Pose2(9.0, 9.0, 0.0), np.eye(3))
    odometry = Odometry(7, Pose2(0.3, -0.1, 0.2), STANDSTILL)
    estimate = truth.update(odometry, Imu(7, 0.0), None)
    assert (estimate.tick, estimate.base_in_map, estimate.updated) == (7, where, True)
    carried = estimate.odom_in_map.compose(odometry.base_in_odom)
    assert carried.array() == pytest.approx(where.array())
    assert not estimate.covariance.any()
    assert estimate.particles.shape == (0, 3)
