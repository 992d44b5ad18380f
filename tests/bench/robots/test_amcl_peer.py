"""Our particle filter beside ROS's own, on the same runs in the same minute.

ROS's stands beside ours only with a checkout of github.com/ros-planning/navigation: `NAVIGATION_SRC=/path make bench`.
"""

import time
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.numerics.float_array import FloatArray
from sim.parameters import AmclParameters
from sim.robot.localization.amcl import Amcl
from tests.bench.budget import Budgets
from tests.bench.robots.amcl_peer import SETTLED, Tracked, run_peer
from tests.bench.robots.recorded_run import Run, kidnapped, part, tour
from thbridge.files.map_files import Map, read_map
from thbridge.files.resources import shipped

pytestmark = pytest.mark.bench

SEEDS = range(1, 11)
INSIDE = 5.99
"""Squared Mahalanobis distance that 95 % of a plane's normal errors stay below."""


@pytest.fixture(scope="session")
def runs(office: Map) -> dict[int, Run]:
    return {seed: tour(office, seed) for seed in SEEDS}


@pytest.fixture(scope="session")
def arena() -> Map:
    return read_map(shipped().find("maps", "arena8", Path()))


@pytest.fixture(scope="session")
def arena_runs(arena: Map) -> dict[int, Run]:
    return {seed: tour(arena, seed) for seed in SEEDS}


def ours(run: Run, place: Map, parameters: AmclParameters, seed: int, known: bool = True) -> Tracked:
    localizer = Amcl(parameters, place.grid, run.mount, seed, "robot1")
    if known:
        localizer.start(Pose2(*run.truth[0]), np.diag([0.25, 0.25, (np.pi / 12) ** 2]))
    else:
        localizer.globalize()
    errors, seconds, covered, lost = [], [], [], []
    for (odometry, imu, scan), truth in zip(run.observations, run.truth, strict=True):
        began = time.process_time()
        estimate = localizer.update(odometry, imu, scan)
        spent = time.process_time() - began
        if estimate.updated:
            seconds.append(spent)
            off = estimate.base_in_map.array()[:2] - truth[:2]
            errors.append(np.hypot(*off))
            covered.append(off @ np.linalg.solve(estimate.covariance[:2, :2], off) < INSIDE)
            lost.append(estimate.lost)
    return Tracked(np.array(errors), np.array(seconds), np.array(covered), np.array(lost))


def theirs(
    peer: Path | None, runs: dict[int, Run], place: Map, folder: Path, model: str, particles: tuple[int, int],
    known: bool = True,
) -> list[Tracked]:  # fmt: skip
    """What ROS's filter makes of the runs; nothing without its source."""
    if peer is None:
        return []
    return [run_peer(peer, run, place.grid, folder, model, particles, seed, known) for seed, run in runs.items()]


def told(name: str, tracked: list[Tracked]) -> str:
    if not tracked:
        return f"{name:>44}: not measured"
    errors, seconds = settled(tracked, "errors"), settled(tracked, "seconds")
    return (
        f"{name:>44}: mean {100 * errors.mean():5.1f} cm, 95 % {100 * np.percentile(errors, 95):5.1f} cm, "
        f"worst {100 * errors.max():5.1f} cm; {1e3 * np.median(seconds):6.2f} ms an update, longest "
        f"{1e3 * seconds.max():6.1f} ms{told_besides(tracked)}"
    )


def told_besides(tracked: list[Tracked]) -> str:
    if not tracked[0].covered.size:
        return ""
    covered, lost = settled(tracked, "covered"), settled(tracked, "lost")
    return f"; 95 % ellipse held the truth in {covered.mean():.2f}, lost {np.count_nonzero(lost)} of {len(lost)}"


def settled(tracked: list[Tracked], what: str) -> FloatArray:
    """Of all runs together, after the first uncertainty."""
    return np.concatenate([getattr(one, what)[SETTLED:] for one in tracked])


def judge(what: str, mine: list[Tracked], other: list[Tracked], budgets: Budgets) -> None:
    """Errors stay small, ellipses hold the truth, and updates are as quick as they were."""
    assert settled(mine, "errors").mean() < 0.04
    assert settled(mine, "covered").mean() > 0.9
    seconds = float(np.median(settled(mine, "seconds")))
    budgets.time(f"amcl: an update, {what}", seconds)
    if other:
        budgets.ratio(f"amcl: an update, {what}, beside ROS's", seconds / np.median(settled(other, "seconds")))


def found(tracked: list[Tracked]) -> int:
    """How many end within 0.5 m."""
    return sum(float(np.mean(one.errors[-5:])) < 0.5 for one in tracked)


@pytest.mark.parametrize("model", ["likelihood_field", "likelihood_field_prob", "beam"])
def test_accuracy_of_tracking(model, amcl_peer, office, runs, budgets, tmp_path, capsys):
    defaults = AmclParameters(laser_model_type=model, laser_max_beams=60)
    mine = [ours(run, office, defaults, seed) for seed, run in runs.items()]
    other = theirs(amcl_peer, runs, office, tmp_path, model, (100, 5000))
    with capsys.disabled():
        print(f"\n{told(f'ours, {model}', mine)}\n{told(f'amcl, {model}', other)}")
    judge(model, mine, other, budgets)


@pytest.mark.parametrize("count", [500, 2000, 5000, 20000])
def test_error_and_cost_against_the_number_of_particles(count, amcl_peer, office, runs, budgets, tmp_path, capsys):
    fixed = AmclParameters(min_particles=count, max_particles=count, laser_max_beams=60)
    few = {seed: runs[seed] for seed in list(SEEDS)[:2]}
    mine = [ours(run, office, fixed, seed) for seed, run in few.items()]
    other = theirs(amcl_peer, few, office, tmp_path, "likelihood_field", (count, count))
    with capsys.disabled():
        print(f"\n{told(f'ours, {count} particles', mine)}\n{told(f'amcl, {count} particles', other)}")
    judge(f"{count} particles", mine, other, budgets)


@pytest.mark.timeout(900)
@pytest.mark.parametrize("name", ["office", "arena8"])
@pytest.mark.parametrize("count", [500, 2000, 5000, 20000])
def test_global_localisation_and_kidnapping(
    count, name, amcl_peer, office, arena, runs, arena_runs, budgets, tmp_path, capsys
):
    place, tours = (office, runs) if name == "office" else (arena, arena_runs)
    most = AmclParameters(max_particles=count, laser_max_beams=60)
    # With more particles that never agree its resampling, quadratic in them, takes long.
    rival = amcl_peer if count == 2000 else None
    for task, known in (("anywhere", False), ("after a kidnapping", True)):
        begun = {seed: kidnapped(run, seed) if known else part(run, 100, 600) for seed, run in tours.items()}
        mine = [ours(run, place, most, seed, known) for seed, run in begun.items()]
        other = theirs(rival, begun, place, tmp_path, "likelihood_field", (100, count), known)
        sure = [np.count_nonzero((one.errors > 1.0) & ~one.lost) / len(one.errors) for one in mine]
        longest = [one.seconds.max() for one in mine]
        with capsys.disabled():
            print(
                f"\n{name}, {count} particles at most, found itself {task} within 0.5 m: ours {found(mine)}, amcl "
                f"{found(other) if other else 'not measured:'} of {len(tours)}; over 1 m off and not lost in "
                f"{np.mean(sure):.3f} of updates; longest {1e3 * max(longest):.0f} ms"
            )
        assert found(mine) == len(tours)
        assert np.mean(sure) < 0.1
        budgets.time(f"amcl: finding itself {task}, {name}, {count} particles", float(settled(mine, "seconds").sum()))
