"""Our particle filter beside ROS's own, on the same runs in the same minute.

Needs a checkout of github.com/ros-planning/navigation: `NAVIGATION_SRC=/path make bench`.
"""

import subprocess
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from sim.geometry import FloatArray, Pose2
from sim.localization.amcl import Amcl
from sim.parameters import AmclParameters
from tests.bench.recorded_run import Run, tour, write_for_peer
from thbridge.adapters.map_files import Map

pytestmark = pytest.mark.bench

SEEDS = range(1, 11)
SETTLED = 5
"""Updates after which the first uncertainty is over."""
AMCL_SOURCES = [
    "pf/pf.c", "pf/eig3.c", "pf/pf_kdtree.c", "pf/pf_pdf.c", "pf/pf_vector.c", "map/map.c", "map/map_range.c",
    "map/map_cspace.cpp", "sensors/amcl_sensor.cpp", "sensors/amcl_laser.cpp", "sensors/amcl_odom.cpp",
]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Tracked:
    """What a filter made of a run: metres off at each update, and CPU seconds of each."""

    errors: FloatArray
    seconds: FloatArray


@pytest.fixture(scope="session")
def peer(navigation, tmp_path_factory) -> Path:
    """ROS's filter, built as ROS builds it for release."""
    package, folder = navigation / "amcl", tmp_path_factory.mktemp("amcl")
    flags = ["-O3", "-DNDEBUG", "-DHAVE_DRAND48", "-DHAVE_UNISTD_H"]
    flags += [f"-I{package / 'include'}", f"-I{package / 'include/amcl'}", f"-I{package / 'src/include'}"]
    objects = []
    for name in AMCL_SOURCES:
        built = folder / f"{Path(name).stem}.o"
        compiler = "gcc" if name.endswith(".c") else "g++"
        subprocess.run([compiler, *flags, "-c", package / "src/amcl" / name, "-o", built], check=True)
        objects.append(built)
    program = folder / "amcl_peer"
    main = Path(__file__).parent / "peers" / "amcl_peer.cpp"
    subprocess.run(["g++", *flags, main, *objects, "-o", program], check=True)
    return program


@pytest.fixture(scope="session")
def runs(office: Map) -> dict[int, Run]:
    return {seed: tour(office, seed) for seed in SEEDS}


def ours(run: Run, place: Map, parameters: AmclParameters, seed: int, known: bool = True) -> Tracked:
    localizer = Amcl(parameters, place.grid, run.mount, seed, "robot1")
    if known:
        localizer.start(Pose2(*run.truth[0]), np.diag([0.25, 0.25, (np.pi / 12) ** 2]))
    else:
        localizer.globalize()
    errors, seconds = [], []
    for (odometry, imu, scan), truth in zip(run.observations, run.truth, strict=True):
        began = time.process_time()
        estimate = localizer.update(odometry, imu, scan)
        spent = time.process_time() - began
        if estimate.updated:
            seconds.append(spent)
            errors.append(np.hypot(estimate.base_in_map.x - truth[0], estimate.base_in_map.y - truth[1]))
    return Tracked(np.array(errors), np.array(seconds))


def theirs(
    peer: Path, run: Run, place: Map, folder: Path, model: str, particles: tuple[int, int], seed: int,
    known: bool = True,
) -> Tracked:  # fmt: skip
    drawn, log = write_for_peer(run, place, folder)
    start = [str(value) for value in run.truth[0]] if known else ["global"]
    words = [peer, drawn, log, model, *particles, seed, *start]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True)
    table = np.array([line.split() for line in done.stdout.splitlines()], dtype=np.float64)
    off = table[:, 1:3] - run.truth[table[:, 0].astype(int), :2]
    return Tracked(np.hypot(*off.T), table[:, 5] * 1e-6)


def told(name: str, tracked: list[Tracked]) -> str:
    errors = np.concatenate([one.errors[SETTLED:] for one in tracked])
    seconds = np.concatenate([one.seconds[SETTLED:] for one in tracked])
    return (
        f"{name:>44}: mean {100 * errors.mean():5.1f} cm, 95 % {100 * np.percentile(errors, 95):5.1f} cm, "
        f"worst {100 * errors.max():5.1f} cm; {1e3 * np.median(seconds):6.2f} ms an update, longest "
        f"{1e3 * seconds.max():6.1f} ms"
    )


@pytest.mark.parametrize("model", ["likelihood_field", "likelihood_field_prob", "beam"])
def test_accuracy_of_tracking(model, peer, office, runs, tmp_path, capsys):
    defaults = AmclParameters(laser_model_type=model, laser_max_beams=60)
    mine = [ours(run, office, defaults, seed) for seed, run in runs.items()]
    other = [theirs(peer, run, office, tmp_path, model, (100, 5000), seed) for seed, run in runs.items()]
    with capsys.disabled():
        print(f"\n{told(f'ours, {model}', mine)}\n{told(f'amcl, {model}', other)}")


@pytest.mark.parametrize("count", [500, 2000, 5000, 20000])
def test_error_and_cost_against_the_number_of_particles(count, peer, office, runs, tmp_path, capsys):
    fixed = AmclParameters(min_particles=count, max_particles=count, laser_max_beams=60)
    few = {seed: runs[seed] for seed in list(SEEDS)[:2]}
    mine = [ours(run, office, fixed, seed) for seed, run in few.items()]
    other = [theirs(peer, run, office, tmp_path, "likelihood_field", (count, count), seed) for seed, run in few.items()]
    with capsys.disabled():
        print(f"\n{told(f'ours, {count} particles', mine)}\n{told(f'amcl, {count} particles', other)}")


@pytest.mark.parametrize("count", [500, 2000, 5000, 20000])
def test_global_localisation(count, peer, office, runs, tmp_path, capsys):
    most = AmclParameters(max_particles=count, laser_max_beams=60)
    mine = [ours(run, office, most, seed, known=False) for seed, run in runs.items()]
    other = [
        theirs(peer, run, office, tmp_path, "likelihood_field", (100, count), seed, known=False)
        for seed, run in runs.items()
    ]
    found = [sum(float(np.mean(one.errors[-5:])) < 0.5 for one in tracked) for tracked in (mine, other)]
    with capsys.disabled():
        print(
            f"\nfound itself within 0.5 m, {count} particles at most: ours {found[0]}, amcl {found[1]} of {len(SEEDS)}"
        )
