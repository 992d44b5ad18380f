"""Our particle filter beside ROS's own where maps, wheels and lasers are not as they are believed to be.

ROS's stands beside ours only with a checkout of github.com/ros-planning/navigation: `NAVIGATION_SRC=/path make bench`.
"""

from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from sim.parameters import AmclParameters
from sim.robot.localization.amcl import Amcl
from tests.bench.robots.test_amcl_peer import SETTLED, peer, run_peer  # noqa: F401 - a fixture
from tests.bench.robots.troubled_runs import TroubledRun, troubled_runs
from thbridge.files.map_files import Map

pytestmark = [pytest.mark.bench, pytest.mark.timeout(1800)]

SEEDS = range(1, 21)
JUMP = 1.0
"""Metres by which a correction is a jump, and an estimate wrong."""


def tracked(troubled: TroubledRun, seed: int) -> FloatArray:
    """(n, 3) of each update: metres off, metres by which the correction moved the robot, 1 where it said to be lost."""
    run = troubled.run
    amcl = Amcl(AmclParameters(laser_max_beams=60), troubled.believed.grid, run.mount, seed, "robot1")
    amcl.start(Pose2(*run.truth[0]), np.diag([0.25, 0.25, (np.pi / 12) ** 2]))
    rows, correction = [], None
    for (odometry, imu, scan), truth in zip(run.observations, run.truth, strict=True):
        estimate = amcl.update(odometry, imu, scan)
        if estimate.updated:
            carried = (correction or estimate.odom_in_map).compose(odometry.base_in_odom)
            correction = estimate.odom_in_map
            off = np.hypot(*(estimate.base_in_map.array()[:2] - truth[:2]))
            rows.append((off, carried.distance(estimate.base_in_map), estimate.lost))
    return np.array(rows[SETTLED:], dtype=np.float64)


def test_trouble_moves_the_robot_little_and_no_jump_is_told_as_certain(
    peer: Path | None,  # noqa: F811
    office: Map,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    mine: dict[str, list[FloatArray]] = {}
    other: dict[str, list[FloatArray]] = {}
    for seed in SEEDS:
        for troubled in troubled_runs(office, seed):
            mine.setdefault(troubled.trouble, []).append(tracked(troubled, seed))
            if peer is not None:
                place, model, most = troubled.believed, "likelihood_field", (100, 5000)
                ros = run_peer(peer, troubled.run, place, tmp_path, model, most, seed, known=True)
                other.setdefault(troubled.trouble, []).append(ros.errors[SETTLED:])
    failed = []
    for trouble, runs in mine.items():
        off, moved, lost = np.concatenate(runs).T
        jumps, certain = moved > JUMP, (moved > JUMP) & (lost == 0.0)
        wrong_and_sure = np.mean((off > JUMP) & (lost == 0.0))
        line = (
            f"{trouble:>28}: ours {100 * off.mean():5.1f}, {100 * np.percentile(off, 95):6.1f} cm; "
            f"jumps {jumps.sum()}, as certain {certain.sum()}; lost {lost.mean():.3f}, "
            f"wrong and sure {wrong_and_sure:.4f}"
        )
        better = True
        if trouble in other:
            theirs = np.concatenate(other[trouble])
            line += (
                f"; amcl {100 * theirs.mean():5.1f}, {100 * np.percentile(theirs, 95):6.1f} cm, wrong and sure "
                f"{np.mean(theirs > JUMP):.4f}"
            )
            better = bool(off.mean() < theirs.mean())
        with capsys.disabled():
            print(f"\n{line}", end="")
        if certain.any() or not better:
            failed.append(line)
    assert not failed
