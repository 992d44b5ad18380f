import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

from sim.geometry import Pose2, wrap_angle
from sim.localization.ekf import Ekf, EkfBelief
from sim.observations import Imu
from sim.parameters import EkfParameters

PARAMETERS = EkfParameters()
VAGUE = np.diag((0.25, 0.25, 0.07))


def ekf_of(drive, parameters=PARAMETERS, covariance=VAGUE):
    ekf = Ekf(parameters, drive.grid, drive.mount)
    ekf.start(drive.start, covariance)
    return ekf


def run(localizer, moments):
    return [localizer.update(moment.odometry, moment.imu, moment.scan) for moment in moments]


def test_filterpy_is_imported_only_when_a_filter_is_made():
    code = "import sys, sim.localization.ekf; print('filterpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


def test_before_the_first_scan_it_believes_what_it_was_told(drive):
    tour = drive(seconds=2)
    estimate = ekf_of(tour).update(tour.moments[0].odometry, tour.moments[0].imu, None)
    assert estimate.base_in_map.array() == pytest.approx(tour.start.array())
    assert (estimate.covariance == VAGUE).all()
    assert estimate.particles.shape == (0, 3)
    assert not estimate.updated


@pytest.mark.parametrize(
    ("noise", "others", "mean", "worst"), [(1.0, 0, 0.015, 0.08), (5.0, 0, 0.06, 0.25), (1.0, 5, 0.02, 0.1)]
)
@pytest.mark.parametrize("seed", [1, 2])
def test_it_tracks_through_the_arena(drive, seed, noise, others, mean, worst):
    tour = drive(seed=seed, noise=noise, others=others)
    estimates = run(ekf_of(tour), tour)
    errors = np.array([m.truth.distance(e.base_in_map) for m, e in zip(tour, estimates, strict=True)])
    assert errors.mean() < mean
    assert errors.max() < worst


@pytest.mark.parametrize("noise", [1.0, 5.0])
def test_it_is_not_surer_than_it_is_right(drive, noise):
    # Normalised estimation error squared (Bar-Shalom): three degrees of freedom, so 3 on the mean for an honest filter.
    alpha = 0.01 * noise
    told = replace(
        PARAMETERS,
        gyro_noise=0.01 * noise,
        odom_alpha1=alpha,
        odom_alpha2=alpha,
        odom_alpha3=alpha,
        odom_alpha4=alpha,
    )
    nees = []
    for seed in (1, 2, 3):
        tour = drive(seed=seed, noise=noise)
        for moment, estimate in zip(tour, run(ekf_of(tour, told), tour), strict=True):
            if estimate.updated:
                error = moment.truth.array() - estimate.base_in_map.array()
                error[2] = wrap_angle(error[2])
                nees.append(error @ np.linalg.solve(estimate.covariance, error))
    assert 0.1 < np.mean(nees) < 4.5
    assert np.mean(np.array(nees) < chi2.ppf(0.95, 3)) > 0.8


def test_doubt_grows_on_the_way_and_a_match_lessens_it(drive):
    tour = drive(seconds=10)
    ekf = ekf_of(tour)
    run(ekf, tour.moments[:250])
    before = None
    grew = shrank = False
    for moment in tour.moments[250:]:
        estimate = ekf.update(moment.odometry, moment.imu, moment.scan)
        doubt = np.trace(estimate.covariance)
        if before is not None and estimate.updated:
            shrank = shrank or doubt < before
        elif before is not None:
            assert doubt >= before - 1e-12
            grew = grew or doubt > before
        before = doubt
    assert grew and shrank


def test_a_standing_robot_does_not_turn_with_the_gyroscopes_noise(drive):
    tour = drive(seconds=2)
    ekf = ekf_of(tour)
    odometry, scan = tour.moments[0].odometry, tour.moments[0].scan
    first = ekf.update(odometry, Imu(0, 0.0), scan)
    for tick in range(1, 200):
        last = ekf.update(replace(odometry, tick=tick), Imu(tick, 0.5), None)
    assert last.base_in_map.theta == pytest.approx(first.base_in_map.theta, abs=1e-12)


def test_a_scan_from_elsewhere_is_not_believed(drive):
    tour = drive()
    ekf = ekf_of(tour)
    run(ekf, tour.moments[:500])
    elsewhere = tour.moments[2000].scan
    refused = 0
    for moment in tour.moments[500:550]:
        scan = None if moment.scan is None else replace(elsewhere, tick=moment.odometry.tick)
        estimate = ekf.update(moment.odometry, moment.imu, scan)
        refused += scan is not None and not estimate.updated
        assert moment.truth.distance(estimate.base_in_map) < 0.3
    assert refused >= 5


def test_the_same_again_and_a_state_is_a_new_beginning(drive):
    tour = drive(seconds=20)
    ekf = ekf_of(tour)
    run(ekf, tour.moments[:503])
    state = ekf.state
    assert isinstance(state.belief, EkfBelief)
    expected = run(ekf, tour.moments[503:])
    other = Ekf(PARAMETERS, tour.grid, tour.mount)
    other.restore(state)
    for one, two in zip(expected, run(other, tour.moments[503:]), strict=True):
        assert one.base_in_map == two.base_in_map
        assert one.covariance.tobytes() == two.covariance.tobytes()


def test_it_begins_anew_where_it_is_told(drive):
    tour = drive(seconds=10)
    ekf = ekf_of(tour)
    run(ekf, tour.moments[:250])
    ekf.start(Pose2(9.0, 5.0, 1.0), VAGUE)
    estimate = ekf.update(tour.moments[250].odometry, tour.moments[250].imu, None)
    assert estimate.base_in_map.array() == pytest.approx((9.0, 5.0, 1.0))


def test_told_that_it_may_be_anywhere_it_says_so_until_it_is_told_a_pose(drive):
    tour = drive(seconds=10)
    ekf = ekf_of(tour)
    run(ekf, tour.moments[:250])
    ekf.globalize()
    for estimate in run(ekf, tour.moments[250:300]):
        assert estimate.lost and not estimate.updated
        assert estimate.covariance[0, 0] > 10.0
    ekf.start(tour.moments[300].truth, VAGUE)
    found = run(ekf, tour.moments[300:310])[-1]
    assert not found.lost
    assert found.covariance[0, 0] < 0.3


def test_asked_for_it_weighs_a_scan_though_the_robot_stands(drive):
    tour = drive(seconds=2)
    ekf = ekf_of(tour)
    odometry, scan = tour.moments[0].odometry, tour.moments[0].scan
    assert ekf.update(odometry, Imu(0, 0.0), scan).updated
    assert not ekf.update(replace(odometry, tick=5), Imu(5, 0.0), scan).updated
    ekf.request_update()
    assert ekf.update(replace(odometry, tick=10), Imu(10, 0.0), scan).updated
    assert not ekf.update(replace(odometry, tick=15), Imu(15, 0.0), scan).updated
