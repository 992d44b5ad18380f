"""Sensors that err otherwise from some moment on."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.observations import Twist
from sim.inputs import DriveManually, KillRobot, ReviveRobot, SetWorldParameters, TeamInput
from sim.parameters import ParameterRejection, RobotParameters, WorldParameters, live_parameters, reconfigured
from sim.snapshot import TeamSnapshot
from sim.team import Team
from thbridge.files.map_files import read_map

ARENA = read_map(Path(__file__).parents[3] / "maps" / "arena8")
TRUE = WorldParameters()
KNOWING = replace(RobotParameters(), localization="truth")
SECOND = 50


def with_noise(path: str, value: float, parameters: WorldParameters = TRUE) -> WorldParameters:
    changed = reconfigured(parameters, f"world.{path}", value)
    assert isinstance(changed, WorldParameters), changed
    return changed


def team_of(robots: int = 2, world: WorldParameters = TRUE) -> Team:
    return Team(ARENA.grid, world, [KNOWING] * robots, ARENA.starts[:robots], 3, 1e9)


def run(team: Team, ticks: int, *inputs: TeamInput) -> list[TeamSnapshot]:
    return [team.step(inputs), *(team.step() for _ in range(ticks - 1))]


def perceived(snapshots: list[TeamSnapshot], robot: int) -> list[object]:
    """All that a robot perceived, to the last bit."""
    seen = [snapshot.robots[robot].observations for snapshot in snapshots]
    return [
        (each.odometry, each.imu, None if each.scan is None else each.scan.ranges.tobytes(), each.battery)
        for each in seen
    ]


def ranges(snapshots: list[TeamSnapshot], robot: int) -> np.ndarray:
    scans = [snapshot.robots[robot].observations.scan for snapshot in snapshots]
    return np.array([scan.ranges for scan in scans if scan is not None])


TURNING = DriveManually(1, Twist(0.3, 0.4), 10 * SECOND)
WORSE = replace(with_noise("gyro_noise", 1.0, with_noise("laser.range_noise", 0.5)), odometry=TRUE.odometry)


def test_the_others_perceive_every_bit_as_if_nothing_had_happened() -> None:
    plain, disturbed = team_of(), team_of()
    before, after = run(plain, SECOND, TURNING), run(disturbed, SECOND, TURNING, SetWorldParameters(1, WORSE))
    assert perceived(before, 0) == perceived(after, 0)
    assert perceived(before, 1) != perceived(after, 1)


def test_what_errs_as_before_errs_by_the_same_numbers() -> None:
    # The magnitudes are factors of noise that is keyed by the tick: to put them back is as if nothing had happened.
    plain, disturbed = team_of(), team_of()
    run(plain, SECOND, TURNING)
    run(disturbed, SECOND, TURNING, SetWorldParameters(1, WORSE))
    assert perceived(run(plain, SECOND), 1) == perceived(run(disturbed, SECOND, SetWorldParameters(1, TRUE)), 1)


def test_equal_parameters_change_no_bit() -> None:
    plain, same = team_of(), team_of()
    same_again = with_noise("gyro_noise", TRUE.gyro_noise)
    for robot in range(2):
        before, after = run(plain, SECOND, TURNING), run(same, SECOND, TURNING, SetWorldParameters(robot, same_again))
        assert [perceived(before, each) for each in range(2)] == [perceived(after, each) for each in range(2)]


def test_ranges_err_by_the_new_deviation_and_bias_from_the_very_tick_on() -> None:
    team = team_of(1, with_noise("laser.dropout", 0.0))
    exact, *_ = ranges(run(team, 5, SetWorldParameters(0, with_noise("laser.range_noise", 0.0, team.worlds[0]))), 0)
    noisy = with_noise("laser.range_bias", 0.1, with_noise("laser.range_noise", 0.2, team.worlds[0]))
    within = (exact > 1.5) & (exact < 6.5)  # No limit of the laser cuts them.
    errors = ranges(run(team, 20 * SECOND, SetWorldParameters(0, noisy)), 0)[:, within] - exact[within]
    assert errors.size > 1000
    assert errors.mean() == pytest.approx(0.1, abs=0.005)
    assert errors.std() == pytest.approx(0.2, rel=0.03)


def test_all_beams_can_get_lost_and_come_back() -> None:
    team = team_of(1)
    assert np.isnan(ranges(run(team, 10, SetWorldParameters(0, with_noise("laser.dropout", 1.0))), 0)).all()
    assert not np.isnan(ranges(run(team, 10, SetWorldParameters(0, with_noise("laser.dropout", 0.0))), 0)).any()


def test_wheels_and_gyroscope() -> None:
    still = replace(TRUE, gyro_noise=0.0, odometry=replace(TRUE.odometry, alpha1=0, alpha2=0, alpha3=0, alpha4=0))
    team = team_of(1, still)
    run(team, SECOND, DriveManually(0, Twist(0.2, 0.1), 10 * SECOND))
    wrong = replace(still, odometry=replace(still.odometry, linear_scale=1.5, angular_scale=0.5))
    (snapshot,) = run(team, 1, SetWorldParameters(0, wrong))
    twist = snapshot.robots[0].observations.odometry.twist
    assert (twist.linear, twist.angular) == pytest.approx((0.3, 0.05), rel=1e-4)
    assert snapshot.robots[0].observations.imu.angular_velocity == pytest.approx(0.1)
    rates = [
        each.robots[0].observations.imu.angular_velocity
        for each in run(team, 5 * SECOND, SetWorldParameters(0, replace(still, gyro_noise=0.3)))
    ]
    assert np.std(rates) == pytest.approx(0.3, rel=0.15)


def test_the_sensors_of_a_dead_robot_change_too() -> None:
    team = team_of(1)
    run(team, 10, KillRobot(0))
    run(team, 1, SetWorldParameters(0, with_noise("laser.dropout", 1.0)))
    assert np.isnan(ranges(run(team, 10, ReviveRobot(0)), 0)).all()


def test_the_team_tells_what_is_true_of_each_robot() -> None:
    team = team_of()
    assert team.worlds == (TRUE, TRUE)
    run(team, 1, SetWorldParameters(1, WORSE))
    assert team.worlds == (TRUE, WORSE)


def test_a_body_does_not_change_while_it_runs() -> None:
    team = team_of()
    with pytest.raises(ValueError, match=r"robot 1: these parameters cannot change while it runs: laser\.beams"):
        run(team, 1, SetWorldParameters(1, replace(TRUE, laser=replace(TRUE.laser, beams=90))))


def test_only_magnitudes_of_noise_are_live() -> None:
    assert [parameter.path for parameter in live_parameters(WorldParameters, "world")] == [
        "world.gyro_noise",
        *(f"world.odometry.{name}" for name in ("alpha1", "alpha2", "alpha3", "alpha4")),
        "world.odometry.linear_scale",
        "world.odometry.angular_scale",
        "world.laser.range_noise",
        "world.laser.range_bias",
        "world.laser.dropout",
    ]


@pytest.mark.parametrize(
    ("path", "value", "reason"),
    [
        ("world.laser.beams", 90, "fixed"),
        ("world.max_vel_x", 2.0, "fixed"),
        ("world.laser.colour", 1, "unknown"),
        ("world.laser", 1, "fixed"),
        ("world.laser.dropout", 1.5, "range"),
        ("world.laser.dropout", "half", "kind"),
        ("world.gyro_noise", float("nan"), "kind"),
    ],
)
def test_what_is_true_keeps_its_bounds(path: str, value: object, reason: str) -> None:
    result = reconfigured(TRUE, path, value)
    assert isinstance(result, ParameterRejection)
    assert (result.path, result.reason) == (path, reason)
    assert path in result.sentence
