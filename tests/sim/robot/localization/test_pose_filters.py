"""The extended and the unscented Kalman filter on filterpy: their algebra, and their bits on any processor."""

import math
import os
import subprocess
import sys

import filterpy.kalman.kalman_filter
import filterpy.kalman.UKF
import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.numerics.elementary import wrap_angle
from sim.parameters import UkfParameters
from sim.robot.localization.pose_filters import ExtendedPoseFilter, MeasuredMotion, UnscentedPoseFilter
from tests.sim.robot.localization.portable_filters import digest_of, filters, random_steps
from tests.support.programs.processor_features import LIBM_WITHOUT_FMA, NUMPY_PLAIN
from tests.support.project import ROOT

HERE = Pose2(1.0, -2.0, 3.1)
STEP = Pose2(0.5, 0.1, 0.3)
DOUBT = np.array(((0.04, 0.01, 0.002), (0.01, 0.03, -0.001), (0.002, -0.001, 0.0025)))


def of_each(*, mean=HERE, covariance=DOUBT):
    made = {"ekf": ExtendedPoseFilter(), "ukf": UnscentedPoseFilter(UkfParameters())}
    for each in made.values():
        each.reset(mean, covariance)
    return made


@pytest.fixture(params=["ekf", "ukf"])
def pose_filter(request):
    return of_each()[request.param]


def samples_of(pose_filter, count=100_000):
    return np.random.default_rng(1).multivariate_normal(pose_filter.mean.array(), pose_filter.covariance, count)


def moved(poses, step, turns=0.0):
    x, y, theta = poses.T
    c, s = np.cos(theta), np.sin(theta)
    return np.column_stack((x + c * step.x - s * step.y, y + s * step.x + c * step.y, theta + step.theta + turns))


def test_a_motion_moves_the_gaussian_as_it_moves_samples(pose_filter):
    samples = moved(samples_of(pose_filter), STEP)
    pose_filter.predict(MeasuredMotion(STEP, 0.0, 0.0))
    assert pose_filter.mean.distance(Pose2(*samples.mean(axis=0))) < 0.002
    assert wrap_angle(pose_filter.mean.theta - samples[:, 2].mean()) == pytest.approx(0.0, abs=0.001)
    assert pose_filter.covariance == pytest.approx(np.cov(samples.T), abs=0.0005)


def test_a_motion_adds_its_own_noise(pose_filter):
    pose_filter.reset(HERE, np.zeros((3, 3)))
    draw = np.random.default_rng(1)
    lengths, turns = draw.normal(1.0, 0.1, 100_000), draw.normal(0.0, 0.05, 100_000)
    # An error of the turn turns the chord by half of it.
    before = np.column_stack(
        (np.zeros((100_000, 2)), np.full(100_000, HERE.theta + math.atan2(STEP.y, STEP.x)) + turns / 2.0)
    )
    samples = moved(before, Pose2(math.hypot(STEP.x, STEP.y), 0.0, 0.0), turns / 2.0)
    samples[:, :2] *= lengths[:, np.newaxis]
    length = math.hypot(STEP.x, STEP.y)
    pose_filter.predict(MeasuredMotion(STEP, (0.1 * length) ** 2, 0.05**2))
    assert pose_filter.covariance == pytest.approx(np.cov(samples.T), abs=0.0001)


def test_a_measurement_is_weighed_by_its_covariance(pose_filter):
    noise = np.diag((0.01, 0.02, 0.001))
    innovation = np.array((0.1, -0.05, 0.08))
    # Beyond half a turn: 3.1 and 0.08 more.
    measured = Pose2(HERE.x + 0.1, HERE.y - 0.05, wrap_angle(HERE.theta + 0.08))
    gain = DOUBT @ np.linalg.inv(DOUBT + noise)
    expected = HERE.array() + gain @ innovation
    pose_filter.update(measured, noise)
    assert pose_filter.mean.array() == pytest.approx((*expected[:2], wrap_angle(expected[2])))
    assert pose_filter.covariance == pytest.approx((np.eye(3) - gain) @ DOUBT)


def test_where_the_heading_is_vague_the_unscented_mean_is_that_of_samples():
    made = of_each(covariance=np.diag((0.01, 0.01, 0.16)))
    truth = Pose2(*moved(samples_of(made["ekf"]), Pose2(3.0, 0.0, 0.0)).mean(axis=0))
    for each in made.values():
        each.predict(MeasuredMotion(Pose2(3.0, 0.0, 0.0), 0.0, 0.0))
    assert made["ekf"].mean.distance(truth) > 0.2
    assert made["ukf"].mean.distance(truth) < 0.02


@pytest.mark.parametrize("number", range(len(filters())))
def test_covariances_stay_symmetric_and_positive(number):
    pose_filter = filters()[number]
    for _ in random_steps(pose_filter, 300):
        assert (pose_filter.covariance == pose_filter.covariance.T).all()
        assert np.linalg.eigvalsh(pose_filter.covariance).min() > 0.0


def test_no_product_is_left_to_blas(monkeypatch):
    products = []

    def judged(one, other, dot=np.dot):
        products.append(dot(one, other))
        return products[-1]

    for module in (np, filterpy.kalman.kalman_filter, filterpy.kalman.UKF):
        monkeypatch.setattr(module, "dot", judged)
    for pose_filter in filters():
        products.clear()
        assert list(random_steps(pose_filter, 4))
        assert len(products) > 5
        assert {product.dtype.str for product in products} == {"|O"}


CORE_TYPES = ("Prescott", "Nehalem", "Sandybridge", "Haswell", "Zen", "SkylakeX")


@pytest.mark.slow
@pytest.mark.parametrize(
    "setting",
    [
        *({"OPENBLAS_CORETYPE": name} for name in CORE_TYPES),
        NUMPY_PLAIN,
        LIBM_WITHOUT_FMA,
        {**NUMPY_PLAIN, **LIBM_WITHOUT_FMA, "OPENBLAS_CORETYPE": "Prescott"},
        {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
    ],
    ids=lambda setting: "-".join(setting.values())[:30],
)
def test_estimates_are_the_same_whatever_the_processor(setting):
    command = [sys.executable, "-m", "tests.sim.robot.localization.portable_filters"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **setting}
    said = subprocess.check_output(command, cwd=ROOT, env=environment, text=True)
    assert said.split() == [digest_of(each) for each in filters()]
