"""Our particle filter beside ROS's own where maps, wheels and lasers are not as they are believed to be.

ROS's stands beside ours only with a checkout of github.com/ros-planning/navigation: `NAVIGATION_SRC=/path make bench`.
"""

from collections import defaultdict
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.numerics.float_array import FloatArray
from sim.parameters import AmclParameters
from sim.robot.localization.amcl import Amcl
from tests.bench.robots.amcl_peer import SETTLED, run_peer
from tests.bench.robots.recorded_run import Run
from tests.bench.robots.troubled_runs import troubled_runs
from tests.bench.robots.weaving_car import corridors, weaving_runs
from thbridge.files.map_files import Map
from thbridge.offline.odometry import OdometryTrack
from thbridge.ros.messages.stamps import TICK_NS
from thbridge.ros.odometry_faults import OdometrySample

pytestmark = [pytest.mark.bench, pytest.mark.timeout(1800)]

SEEDS = range(1, 21)
JUMP = 1.0
"""Meters by which a pose is wrong, or is suddenly as much better or worse."""


def tracked(run: Run, believed: OccupancyGrid, seed: int) -> FloatArray:
    """(n, 3) of each update: meters off, meters by which that changed at once, 1 where it said to be lost.

    Odometry is judged as `thbridge localize` does.
    """
    stamps = [odometry.tick * TICK_NS for odometry, _, _ in run.observations]
    told = [odometry.base_in_odom for odometry, _, _ in run.observations]
    track = OdometryTrack(map(OdometrySample, stamps, stamps, told))
    amcl = Amcl(AmclParameters(laser_max_beams=60), believed, run.mount, seed, "robot1")
    amcl.start(Pose2(*run.truth[0]), np.diag([0.25, 0.25, (np.pi / 12) ** 2]))
    rows, before, since_ns = [], np.zeros(2), 0
    for (odometry, imu, scan), truth, stamp_ns in zip(run.observations, run.truth, stamps, strict=True):
        for missed in track.missed(since_ns, stamp_ns):
            amcl.widen(missed.distance, missed.turn)
        since_ns = stamp_ns
        sound = replace(odometry, base_in_odom=track.at(stamp_ns, stamp_ns) or odometry.base_in_odom)
        estimate = amcl.update(sound, imu, scan)
        if estimate.updated:
            off = estimate.base_in_map.array()[:2] - truth[:2]
            rows.append((np.hypot(*off), np.hypot(*(off - before)), estimate.lost))
            before = off
    return np.array(rows[SETTLED:], dtype=np.float64)


@dataclass(frozen=True, slots=True)
class Rows:
    """Updates of our filter and of ROS's, by trouble."""

    ours: dict[str, list[FloatArray]] = field(default_factory=lambda: defaultdict(list))
    theirs: dict[str, list[FloatArray]] = field(default_factory=lambda: defaultdict(list))

    def add(
        self, trouble: str, run: Run, believed: OccupancyGrid, seed: int, program: Path | None, folder: Path
    ) -> None:
        """Run both filters; ROS's only where it is at hand."""
        self.ours[trouble].append(tracked(run, believed, seed))
        if program is not None:
            ros = run_peer(program, run, believed, folder, "likelihood_field", (100, 5000), seed, known=True)
            self.theirs[trouble].append(ros.errors[SETTLED:])

    def failed(self, capsys: pytest.CaptureFixture[str], most_lost: float = 1.0) -> list[str]:
        """Print all rows; return those where ours jumps as certain, is lost too often, or is worse than ROS's."""
        return [line for trouble in self.ours if (line := self._fault(trouble, capsys, most_lost)) is not None]

    def _fault(self, trouble: str, capsys: pytest.CaptureFixture[str], most_lost: float) -> str | None:
        off, moved, lost = np.concatenate(self.ours[trouble]).T
        jumps, certain = moved > JUMP, (moved > JUMP) & (lost == 0.0)
        wrong_and_sure = np.mean((off > JUMP) & (lost == 0.0))
        line = (
            f"{trouble:>36}: ours {100 * off.mean():5.1f}, {100 * np.percentile(off, 95):6.1f} cm; "
            f"jumps {jumps.sum()}, as certain {certain.sum()}; lost {lost.mean():.3f}, "
            f"wrong and sure {wrong_and_sure:.4f}"
        )
        better = True
        if trouble in self.theirs:
            theirs = np.concatenate(self.theirs[trouble])
            line += (
                f"; amcl {100 * theirs.mean():5.1f}, {100 * np.percentile(theirs, 95):6.1f} cm, wrong and sure "
                f"{np.mean(theirs > JUMP):.4f}"
            )
            better = bool(off.mean() < theirs.mean())
        with capsys.disabled():
            print(f"\n{line}", end="")
        return line if certain.any() or not better or lost.mean() >= most_lost else None


def test_trouble_moves_the_robot_little_and_no_jump_is_told_as_certain(
    amcl_peer: Path | None,
    office: Map,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    rows = Rows()
    for seed in SEEDS:
        for troubled in troubled_runs(office, seed):
            rows.add(troubled.trouble, troubled.run, troubled.believed.grid, seed, amcl_peer, tmp_path)
    assert not rows.failed(capsys)


def test_wrong_odometry_is_corrected_by_scans(
    amcl_peer: Path | None,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    rows, grid = Rows(), corridors()
    for seed in SEEDS:
        for trouble, run in weaving_runs(grid, seed):
            rows.add(trouble, run, grid, seed, amcl_peer, tmp_path)
    assert not rows.failed(capsys, most_lost=0.05)
