import math

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Imu, Odometry
from sim.parameters import FakeLocalizationParameters
from sim.robot.localization.fake_localization import FakeLocalization


def test_the_truth_needs_no_telling():
    where = Pose2(1.0, 2.0, 0.5)
    truth = FakeLocalization(FakeLocalizationParameters(), lambda: where)
    truth.start(Pose2(9.0, 9.0, 0.0), np.eye(3))
    odometry = Odometry(7, Pose2(0.3, -0.1, 0.2), STANDSTILL)
    estimate = truth.update(odometry, Imu(7, 0.0), None)
    assert (estimate.tick, estimate.base_in_map, estimate.updated) == (7, where, True)
    carried = estimate.odom_in_map.compose(odometry.base_in_odom)
    assert carried.array() == pytest.approx(where.array())
    assert not estimate.covariance.any()
    assert estimate.particles.shape == (0, 3)


def test_deltas_shift_the_map_beside_the_world():
    # A step by (-delta_x, -delta_y) after a turn by -delta_yaw, as fake_localization does it.
    parameters = FakeLocalizationParameters(delta_x=1.0, delta_y=2.0, delta_yaw=math.pi / 2)
    truth = FakeLocalization(parameters, lambda: Pose2(3.0, 0.0, 0.5))
    estimate = truth.update(Odometry(1, Pose2(0.0, 0.0, 0.0), STANDSTILL), Imu(1, 0.0), None)
    assert estimate.base_in_map.array() == pytest.approx((-1.0, -5.0, 0.5 - math.pi / 2))
