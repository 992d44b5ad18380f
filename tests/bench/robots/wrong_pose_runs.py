"""Runs on which the probability that a pose is wrong is fitted and checked: followed, kidnapped, looked for, misled."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim.common.geometry import Pose2
from sim.numerics.elementary import wrap_angle
from sim.numerics.noise_arrays import NoiseStream
from sim.parameters import AmclParameters, EkfParameters, RobotParameters
from sim.robot.localization.amcl import Amcl, ParticleBelief, evidence_of
from sim.robot.localization.ekf import KalmanLocalizer
from sim.robot.localization.estimate import Estimate, Localizer
from sim.robot.localization.wrong_pose import WRONG_DISTANCE, WRONG_TURN
from tests.bench.robots.recorded_run import Run, kidnapped, part, tour
from tests.bench.robots.troubled_runs import free_points, troubled_runs
from thbridge.files.map_files import Map

MOST_PARTICLES = 5000
PARTICLES = (500, 2000, MOST_PARTICLES)
EDGES = (0.0, 0.001, 0.003, 0.01, 0.03, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0)
"""Probabilities between which updates are put together for the table of calibration."""
FIRST_COVARIANCE = np.diag([0.25, 0.25, (math.pi / 12) ** 2])
MISLED = 2.0
"""Least meters by which a start pose is wrong where it is."""


@dataclass(frozen=True, slots=True)
class StartedRun:
    """A run, and the start of its filter.

    Attributes:
        group: "followed", "kidnapped", "anywhere" or "misled".
        name: of the run within its group.
        run: with the truth.
        believed: the map that the filter is given.
        start: pose that the filter starts with; None where it may be anywhere.
        particles: greatest number.
    """

    group: str
    name: str
    run: Run
    believed: Map
    start: Pose2 | None
    particles: int = MOST_PARTICLES


@dataclass(frozen=True, slots=True)
class UpdateRow:
    """One update of a filter: what it knew, the probability that it reported, and whether its pose was wrong.

    The Kalman filter reports a probability with each scan that it looks at.
    """

    localizer: str
    group: str
    name: str
    evidence: tuple[float, ...]
    p_wrong: float
    wrong: bool
    lost: bool


def started_runs(seed: int, office: Map, arena: Map) -> Iterator[StartedRun]:
    """Yield all runs of a seed."""
    for each in troubled_runs(office, seed):
        yield StartedRun("followed", each.trouble, each.run, each.believed, Pose2(*each.run.truth[0]))
    for name, place in (("office", office), ("arena8", arena)):
        whole = tour(place, seed)
        yield StartedRun("followed", name, whole, place, Pose2(*whole.truth[0]))
        begun, carried = part(whole, 100, 600), kidnapped(whole, seed)
        for count in PARTICLES:
            yield StartedRun("anywhere", f"{name}, {count} particles", begun, place, None, count)
            start = Pose2(*carried.truth[0])
            yield StartedRun("kidnapped", f"{name}, {count} particles", carried, place, start, count)
        yield StartedRun("misled", name, begun, place, wrong_start(begun, place, seed))


def wrong_start(run: Run, place: Map, seed: int) -> Pose2:
    """Return a random free pose at least `MISLED` meters from the start of a run."""
    noise = NoiseStream.named(seed, "misled")
    points = free_points(place.grid, 0.3, noise, 50)
    x, y = next(point for point in points if math.dist(point, run.truth[0, :2]) > MISLED)
    return Pose2(x, y, wrap_angle(2.0 * math.pi * float(noise.uniforms(1, 1)[0])))


def is_wrong(pose: Pose2, true: Pose2) -> bool:
    """Return True where a pose is wrong by the thresholds of the model."""
    return pose.distance(true) > WRONG_DISTANCE or abs(wrap_angle(pose.theta - true.theta)) > WRONG_TURN


def updates_of(started: StartedRun, seed: int, localizer: str) -> Iterator[UpdateRow]:
    """Run a localizer, "amcl", "ekf" or "ukf"; yield each update.

    Of runs that differ in the number of particles alone, Kalman filters yield updates of one.
    """
    if localizer != "amcl" and started.particles != MOST_PARTICLES:
        return
    chosen = _amcl(started, seed) if localizer == "amcl" else _kalman(started, localizer)
    for base_in_map, truth, evidence, estimate in chosen:
        if estimate.p_wrong is not None:
            wrong = is_wrong(base_in_map, truth)
            yield UpdateRow(
                localizer, started.group, started.name, tuple(evidence), estimate.p_wrong, wrong, estimate.lost
            )


Followed = Iterator[tuple[Pose2, Pose2, Sequence[float], Estimate]]
"""Believed and true pose, evidence and estimate of each update."""


def _amcl(started: StartedRun, seed: int) -> Followed:
    parameters = AmclParameters(max_particles=started.particles, laser_max_beams=60)
    if started.name == "arena8":
        parameters = RobotParameters().amcl
    amcl = Amcl(parameters, started.believed.grid, started.run.mount, seed, "robot1")
    begin(amcl, started)
    for (odometry, imu, scan), truth in zip(started.run.observations, started.run.truth, strict=True):
        estimate = amcl.update(odometry, imu, scan)
        belief = amcl.state
        if estimate.updated and isinstance(belief, ParticleBelief):
            yield estimate.base_in_map, Pose2(*truth), evidence_of(belief), estimate


def _kalman(started: StartedRun, localizer: str) -> Followed:
    # Runs have the gyroscope at scans alone, which is not enough to count turns.
    software = RobotParameters(localization=localizer, ekf=EkfParameters(imu_used=False))
    kalman = KalmanLocalizer(software, started.believed.grid, started.run.mount)
    begin(kalman, started)
    for (odometry, imu, scan), truth in zip(started.run.observations, started.run.truth, strict=True):
        before = kalman.looked
        estimate = kalman.update(odometry, imu, scan)
        if kalman.looked is not None and kalman.looked is not before:
            yield estimate.base_in_map, Pose2(*truth), kalman.looked, estimate


def begin(localizer: Localizer, started: StartedRun) -> None:
    """Start a localizer as the run says."""
    if started.start is None:
        localizer.globalize()
    else:
        localizer.start(started.start, FIRST_COVARIANCE)


@dataclass(frozen=True, slots=True)
class CalibrationBin:
    """Updates that reported about the same probability.

    Attributes:
        low: least probability.
        high: greatest.
        updates: number of them.
        runs: number of runs that they are from.
        reported: mean probability.
        wrong: share that was wrong.
    """

    low: float
    high: float
    updates: int
    runs: int
    reported: float
    wrong: float

    def __str__(self) -> str:
        """Return a row of Markdown."""
        return (
            f"| {self.low:g} to {self.high:g} | {self.updates} | {self.runs} | {self.reported:.4f} | {self.wrong:.4f} |"
        )


HEAD = "| p | updates | runs | mean p | share wrong |\n|---|---|---|---|---|"


def calibration(runs: Sequence[Sequence[UpdateRow]]) -> list[CalibrationBin]:
    """Return the bins that have any updates."""
    bins = []
    for low, high in pairwise(EDGES):
        inside = [
            (number, row.p_wrong, row.wrong)
            for number, rows in enumerate(runs)
            for row in rows
            if low <= row.p_wrong < high or (row.p_wrong == high == 1.0)
        ]
        if inside:
            numbers, reported, wrong = zip(*inside, strict=True)
            bins.append(
                CalibrationBin(
                    low, high, len(inside), len(set(numbers)), float(np.mean(reported)), float(np.mean(wrong))
                )
            )
    return bins
