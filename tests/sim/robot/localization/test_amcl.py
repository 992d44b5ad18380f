import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.stats import chi2

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, Imu, Odometry, Scan
from sim.parameters import AmclParameters, RobotParameters
from sim.robot.localization.amcl import SETTLED_SCANS, Amcl, ParticleBelief, saved

PARAMETERS = RobotParameters().amcl
VAGUE = np.diag((0.25, 0.25, 0.07))
SURE = np.diag((0.01, 0.01, 0.003))


def amcl_of(drive, parameters=PARAMETERS, seed=1, robot="robot1", covariance=VAGUE):
    amcl = Amcl(parameters, drive.grid, drive.mount, seed, robot)
    amcl.start(drive.start, covariance)
    return amcl


def run(localizer, moments):
    return [localizer.update(moment.odometry, moment.imu, moment.scan) for moment in moments]


def same(one, other):
    return (
        one.tick == other.tick
        and one.base_in_map == other.base_in_map
        and one.odom_in_map == other.odom_in_map
        and one.covariance.tobytes() == other.covariance.tobytes()
        and one.particles.tobytes() == other.particles.tobytes()
        and one.updated == other.updated
    )


def errors_of(drive, estimates):
    return np.array([m.truth.distance(e.base_in_map) for m, e in zip(drive.moments, estimates, strict=True)])


def coverage_of(drive, estimates):
    inside = []
    for moment, estimate in zip(drive.moments, estimates, strict=True):
        away = moment.truth.array()[:2] - estimate.base_in_map.array()[:2]
        inside.append(away @ np.linalg.solve(estimate.covariance[:2, :2], away) < 5.99)
    return np.mean(inside)


def test_before_the_first_scan_it_believes_what_it_was_told(drive):
    tour = drive(seconds=2)
    amcl = amcl_of(tour)
    first = tour.moments[0]
    estimate = amcl.update(first.odometry, first.imu, None)
    assert estimate.base_in_map.array() == pytest.approx(tour.start.array())
    assert (estimate.covariance == VAGUE).all()
    assert estimate.particles.shape == (PARAMETERS.max_particles, 3)
    assert not estimate.updated


def test_the_first_particles_scatter_as_told(drive):
    tour = drive(seconds=2)
    covariance = np.array([[0.2, 0.05, 0.0], [0.05, 0.1, 0.01], [0.0, 0.01, 0.02]])
    amcl = amcl_of(tour, replace(PARAMETERS, max_particles=20000), covariance=covariance)
    particles = amcl.update(tour.moments[0].odometry, tour.moments[0].imu, None).particles.copy()
    particles[:, 2] = np.remainder(particles[:, 2] - tour.start.theta + math.pi, 2 * math.pi) - math.pi
    assert particles.mean(axis=0) == pytest.approx((tour.start.x, tour.start.y, 0.0), abs=0.02)
    assert np.cov(particles.T) == pytest.approx(covariance, abs=0.01)


def test_without_a_start_it_believes_to_be_at_the_origin(drive):
    tour = drive(seconds=2)
    amcl = Amcl(PARAMETERS, tour.grid, tour.mount, 1, "robot1")
    estimate = amcl.update(tour.moments[0].odometry, tour.moments[0].imu, None)
    assert estimate.base_in_map.array() == pytest.approx((0, 0, 0))
    assert estimate.covariance[2, 2] == PARAMETERS.initial_cov_aa


def test_a_standing_robot_weighs_one_scan(drive):
    tour = drive(seconds=2)
    amcl = amcl_of(tour)
    scan = tour.moments[0].scan
    odometry = tour.moments[0].odometry
    updates = [
        amcl.update(replace(odometry, tick=tick), Imu(tick, 0.0), replace(scan, tick=tick)).updated
        for tick in range(0, 50, 5)
    ]
    assert updates == [True] + [False] * 9


@pytest.mark.parametrize(
    ("moved", "due"),
    [
        (Pose2(0.19, 0.19, 0.0), False),  # each axis for itself, whatever the distance
        (Pose2(0.21, 0.0, 0.0), True),
        (Pose2(0.0, -0.21, 0.0), True),
        (Pose2(0.0, 0.0, 0.52), False),
        (Pose2(0.0, 0.0, -0.53), True),
    ],
)
def test_a_scan_is_weighed_after_enough_movement(drive, moved, due):
    tour = drive(seconds=2)
    amcl = amcl_of(tour)
    scan = tour.moments[0].scan
    amcl.update(Odometry(0, Pose2(0, 0, 0), STANDSTILL), Imu(0, 0.0), scan)
    assert not amcl.update(Odometry(1, moved, STANDSTILL), Imu(1, 0.0), None).updated
    assert amcl.update(Odometry(5, moved, STANDSTILL), Imu(5, 0.0), replace(scan, tick=5)).updated == due


def test_between_updates_odometry_carries_the_estimate_on(drive):
    tour = drive(seconds=10)
    previous = None
    for moment, estimate in zip(tour, run(amcl_of(tour), tour), strict=True):
        carried = estimate.odom_in_map.compose(moment.odometry.base_in_odom)
        assert estimate.base_in_map == carried
        if previous is not None and not estimate.updated:
            assert estimate.odom_in_map == previous.odom_in_map
        previous = estimate


def test_the_same_again_bit_for_bit(drive):
    tour = drive(seconds=20)
    pairs = zip(run(amcl_of(tour), tour), run(amcl_of(tour), tour), strict=True)
    assert all(same(one, other) for one, other in pairs)


def test_a_state_is_a_new_beginning(drive):
    tour = drive(seconds=20)
    amcl = amcl_of(tour)
    run(amcl, tour.moments[:500])
    state = amcl.state
    expected = run(amcl, tour.moments[500:])
    other = Amcl(PARAMETERS, tour.grid, tour.mount, 1, "robot1")
    other.state = state
    assert all(same(one, two) for one, two in zip(expected, run(other, tour.moments[500:]), strict=True))


def test_no_two_robots_and_no_two_seeds_draw_alike(drive):
    tour = drive(seconds=2)
    clouds = [
        run(amcl_of(tour, seed=seed, robot=robot), tour)[-1].particles.tobytes()
        for seed, robot in ((1, "robot1"), (1, "robot2"), (2, "robot1"))
    ]
    assert len(set(clouds)) == 3


def test_what_it_gives_away_cannot_be_written(drive):
    tour = drive(seconds=2)
    for estimate in run(amcl_of(tour), tour):
        assert not estimate.particles.flags.writeable
        assert not estimate.covariance.flags.writeable


@pytest.mark.parametrize(
    ("noise", "others", "mean", "worst"), [(1.0, 0, 0.035, 0.15), (5.0, 0, 0.06, 0.25), (1.0, 5, 0.05, 0.2)]
)
@pytest.mark.parametrize("seed", [1, 2])
def test_it_tracks_through_the_arena(drive, seed, noise, others, mean, worst):
    tour = drive(seed=seed, noise=noise, others=others)
    estimates = run(amcl_of(tour, seed=seed), tour)
    errors = errors_of(tour, estimates)
    assert errors.mean() < mean
    assert errors.max() < worst
    assert coverage_of(tour, estimates) > 0.9
    assert not any(estimate.lost for estimate in estimates)


def test_a_sure_filter_gets_by_with_few_particles(drive):
    tour = drive()
    sizes = [len(estimate.particles) for estimate in run(amcl_of(tour), tour)]
    assert sizes[0] == PARAMETERS.max_particles
    assert np.mean(sizes[500:]) < 300


def test_it_begins_anew_where_it_is_told(drive):
    tour = drive(seconds=30)
    amcl = amcl_of(tour)
    run(amcl, tour.moments[:500])
    amcl.start(Pose2(9.0, 5.0, 1.0), SURE)
    estimate = amcl.update(tour.moments[500].odometry, tour.moments[500].imu, None)
    assert estimate.base_in_map.array() == pytest.approx((9.0, 5.0, 1.0))
    amcl.start(tour.moments[501].truth, SURE)
    estimates = run(amcl, tour.moments[501:])
    assert max(m.truth.distance(e.base_in_map) for m, e in zip(tour.moments[501:], estimates, strict=True)) < 0.2


def test_a_blind_scan_changes_no_weights(drive):
    tour = drive(seconds=2)
    amcl = amcl_of(tour)
    blind = Scan(0, tour.mount, np.full(tour.mount.beams, np.nan, dtype=np.float32))
    estimate = amcl.update(tour.moments[0].odometry, tour.moments[0].imu, blind)
    state = amcl.state
    assert isinstance(state, ParticleBelief)
    assert np.ptp(state.place.weights) < 1e-12
    assert state.place.agreement.count == 0
    assert estimate.base_in_map.distance(tour.start) < 0.1


def with_other_odometry(tour, turns=1.0, reset=None):
    """The drive with odometry that reports each turn so many times, and begins again at 0 at one moment."""
    odom, last = Pose2(0.0, 0.0, 0.0), tour.moments[0].odometry.base_in_odom
    for number, moment in enumerate(tour.moments):
        moved = last.between(moment.odometry.base_in_odom)
        last = moment.odometry.base_in_odom
        odom = Pose2(0.0, 0.0, 0.0) if number == reset else odom.compose(Pose2(moved.x, moved.y, turns * moved.theta))
        yield replace(moment, odometry=replace(moment.odometry, base_in_odom=odom))


@pytest.mark.parametrize("wrong", [{"turns": 1.8}, {"reset": 1200}], ids=str)
def test_odometry_that_is_worse_than_its_parameters_say_is_corrected_by_scans(drive, wrong):
    tour = drive(furnished=True)
    moments = list(with_other_odometry(tour, **wrong))
    errors = {}
    for rate in (0.0, PARAMETERS.odom_noise_learning_rate):
        estimates = run(amcl_of(tour, replace(PARAMETERS, odom_noise_learning_rate=rate)), moments)
        weighed = [number for number, estimate in enumerate(estimates) if estimate.updated]
        errors[rate] = errors_of(tour, estimates)[weighed][5:]
    assert errors[rate].mean() < 0.06
    assert errors[rate].max() < 0.3
    assert errors[rate].mean() < 0.8 * errors[0.0].mean()
    assert not any(estimate.lost for estimate in estimates)


def test_a_robot_with_wrong_odometry_is_followed_where_scans_are_a_metre_apart(drive):
    tour = drive(seconds=120, furnished=True)
    amcl = amcl_of(tour, replace(PARAMETERS, update_min_d=1.0, update_min_a=0.7))
    estimates = run(amcl, list(with_other_odometry(tour, turns=1.15)))
    weighed = [number for number, estimate in enumerate(estimates) if estimate.updated]
    assert len(weighed) > 80
    assert errors_of(tour, estimates)[weighed][3:].max() < 0.5
    assert not any(estimate.lost for estimate in estimates)


def kidnapped(tour, when, until):
    """The robot is lifted from its place at one moment to its place at a later one; its wheels do not notice."""
    before = tour.moments[when - 1].odometry.base_in_odom
    lifted = tour.moments[until].odometry.base_in_odom
    for moment in tour.moments[until:]:
        wheels = before.compose(lifted.between(moment.odometry.base_in_odom))
        yield replace(moment, odometry=replace(moment.odometry, base_in_odom=wheels))


def test_a_robot_carried_off_notices_and_mostly_finds_back(drive):
    # Rooms are alike, so some filters settle in a twin of the right place that explains four fifths of every scan.
    tour = drive(seconds=120, furnished=True)
    found = 0
    for seed in range(1, 7):
        amcl = amcl_of(tour, seed=seed)
        run(amcl, tour.moments[:750])
        moments = list(kidnapped(tour, 750, 2000))
        estimates = run(amcl, moments)
        errors = [
            moment.truth.distance(estimate.base_in_map) for moment, estimate in zip(moments, estimates, strict=True)
        ]
        assert errors[0] > 1.0
        noticed = next(estimate for estimate in estimates if estimate.lost)
        assert noticed.tick - moments[0].odometry.tick < 300
        assert max(len(estimate.particles) for estimate in estimates) == PARAMETERS.max_particles
        found += not estimates[-1].lost and np.median(errors[-500:]) < 0.1
    assert found >= 5


def test_a_jump_is_never_told_as_certain(drive):
    tour = drive(seconds=120, furnished=True)
    jumps = 0
    for seed in range(1, 7):
        amcl = amcl_of(tour, seed=seed)
        run(amcl, tour.moments[:750])
        for before, now in pairwise(run(amcl, kidnapped(tour, 750, 2000))):
            if before.base_in_map.distance(now.base_in_map) > 1.0:
                jumps += 1
                assert before.lost
                assert now.lost
    assert jumps >= 2


def test_a_rival_that_takes_the_place_leaves_the_robot_lost_until_it_is_compared_with_other_places(drive):
    tour = drive(seconds=120)
    amcl = amcl_of(tour, seed=4)
    run(amcl, tour.moments[:750])
    updates = [estimate for estimate in run(amcl, kidnapped(tour, 750, 2000)) if estimate.updated]
    lost = [
        [now.lost for now in updates[number + 1 :]]
        for number, (before, now) in enumerate(pairwise(updates))
        if before.base_in_map.distance(now.base_in_map) > 1.0
    ]
    # One scan finds the best other place, two speak against it.
    assert [after[:4] for after in lost] == [[True, True, True, False]]


def test_a_second_behind_something_unmapped_changes_little_and_is_no_loss(drive):
    tour = drive(seconds=30, furnished=True)
    amcl = amcl_of(tour)
    moments = list(tour.moments)
    hidden = [number for number, moment in enumerate(moments) if moment.scan is not None and number > 600][:10]
    for number in hidden:
        ranges = moments[number].scan.ranges.copy()
        ranges[tour.mount.beams // 4 : -tour.mount.beams // 4] = 0.6
        moments[number] = replace(moments[number], scan=replace(moments[number].scan, ranges=ranges))
    estimates = run(amcl, moments)
    assert not any(estimate.lost for estimate in estimates)
    assert max(m.truth.distance(e.base_in_map) for m, e in zip(moments[300:], estimates[300:], strict=True)) < 0.3


def test_with_both_decays_zero_no_particles_are_scattered(drive):
    tour = drive(seconds=120, furnished=True)
    amcl = amcl_of(tour, replace(PARAMETERS, recovery_alpha_slow=0.0, recovery_alpha_fast=0.0))
    run(amcl, tour.moments[:750])
    run(amcl, kidnapped(tour, 750, 2000))
    state = amcl.state
    assert isinstance(state, ParticleBelief)
    assert len(state.place.particles) < 200


@pytest.mark.parametrize("model", ["likelihood_field_prob", "beam"])
def test_every_sensor_model_tracks(drive, model):
    tour = drive(seconds=30)
    parameters = replace(PARAMETERS, laser_model_type=model, do_beamskip=True, selective_resampling=True)
    estimates = run(amcl_of(tour, parameters), tour)
    assert errors_of(tour, estimates)[250:].max() < 0.25
    assert not any(estimate.lost for estimate in estimates)


def test_a_robot_that_may_be_anywhere_is_lost_until_it_is_sure_and_can_be_found(drive):
    # Turned by half a circle the arena is much the same, so that some filters settle in the twin of the right place.
    tour = drive(seconds=60, furnished=True)
    found = 0
    for seed in range(1, 7):
        amcl = Amcl(replace(PARAMETERS, max_particles=5000), tour.grid, tour.mount, seed, "robot1")
        amcl.globalize()
        estimates = run(amcl, tour)
        assert estimates[0].lost
        found += not estimates[-1].lost and tour.moments[-1].truth.distance(estimates[-1].base_in_map) < 0.5
    assert found >= 5


def test_a_search_with_two_equal_results_leaves_the_robot_lost_for_a_dozen_scans_more(drive):
    # Without furniture the arena turned by half a circle is the same.
    tour = drive(seconds=20)
    amcl = Amcl(replace(PARAMETERS, max_particles=2000), tour.grid, tour.mount, 1, "robot1")
    amcl.globalize()
    lost = [estimate.lost for estimate in run(amcl, tour) if estimate.updated]
    state = amcl.state
    assert isinstance(state, ParticleBelief)
    assert not state.anywhere
    assert len(lost) > 40
    assert all(lost[: SETTLED_SCANS + 12])


def test_a_standing_robot_looks_when_asked(drive):
    tour = drive(seconds=2)
    amcl = amcl_of(tour)
    first = tour.moments[0]
    amcl.update(first.odometry, first.imu, first.scan)
    amcl.request_update()
    assert amcl.update(first.odometry, first.imu, first.scan).updated
    assert not amcl.update(first.odometry, first.imu, first.scan).updated


def test_a_saved_pose_is_where_the_next_filter_begins(drive):
    tour = drive(seconds=10)
    last = run(amcl_of(tour), tour)[-1]
    amcl = Amcl(saved(PARAMETERS, last), tour.grid, tour.mount, 1, "robot1")
    first = amcl.update(tour.moments[-1].odometry, tour.moments[-1].imu, None)
    assert first.base_in_map.array() == pytest.approx(last.base_in_map.array())
    assert np.diag(first.covariance) == pytest.approx(np.diag(last.covariance))


@pytest.mark.parametrize("parameters", [AmclParameters(), RobotParameters().amcl], ids=["ros", "hunts"])
def test_among_eight_robots_close_by_its_ellipse_covers_nine_of_ten_errors(drive, parameters):
    inside = []
    for seed in (1, 2):
        tour = drive(seed=seed, others=8)
        amcl = Amcl(parameters, tour.grid, tour.mount, seed, "robot1")
        amcl.start(tour.start, np.diag((0.0025, 0.0025, 0.0025)))
        for moment in tour:
            estimate = amcl.update(moment.odometry, moment.imu, moment.scan)
            if estimate.updated:
                error = moment.truth.array()[:2] - estimate.base_in_map.array()[:2]
                square = error @ np.linalg.solve(estimate.covariance[:2, :2], error)
                inside.append(square < chi2.ppf(0.95, 2))
    assert np.mean(inside) > 0.9


def test_a_widened_cloud_is_wider_around_the_same_place_and_finds_the_way_back(drive):
    tour = drive(seconds=20)
    before, after = tour.moments[:500], tour.moments[500:]
    amcl, again = amcl_of(tour), amcl_of(tour)
    last, _ = run(amcl, before)[-1], run(again, before)
    for each in (amcl, again):
        each.widen(0.3, 0.2)
    belief = amcl.state
    moved = belief.place.particles - last.particles
    moved[:, 2] = np.remainder(moved[:, 2] + math.pi, 2 * math.pi) - math.pi
    assert moved.std(axis=0) == pytest.approx((0.3, 0.3, 0.2), rel=0.3)
    assert np.diag(belief.place.covariance - last.covariance) == pytest.approx((0.09, 0.09, 0.04))
    assert belief.odom_in_map == last.odom_in_map
    estimates = run(amcl, after)
    assert all(map(same, estimates, run(again, after)))
    assert errors_of(replace(tour, moments=after), estimates)[250:].max() < 0.2
    assert not any(estimate.lost for estimate in estimates)


def test_a_pose_is_likely_wrong_where_the_robot_is_elsewhere_and_unlikely_where_it_is_followed(drive):
    tour = drive(seconds=20)
    followed = [each.p_wrong for each in run(amcl_of(tour), tour.moments) if each.updated]
    misled = Amcl(PARAMETERS, tour.grid, tour.mount, 1, "robot1")
    misled.start(Pose2(tour.start.x + 3.0, tour.start.y, tour.start.theta + 2.0), SURE)
    begun = misled.update(tour.moments[0].odometry, tour.moments[0].imu, None)
    assert begun.p_wrong is None, "no scan has been weighed"
    estimates = run(misled, tour.moments[1:])
    there = errors_of(replace(tour, moments=tour.moments[1:]), estimates) > 1.0
    astray = [each.p_wrong for each, wrong in zip(estimates, there, strict=True) if each.updated and wrong]
    assert max(followed[5:]) < 0.05
    assert len(astray) >= 4
    assert np.mean(astray) > 0.5
