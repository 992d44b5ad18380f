"""ROS's own particle filter, run on recorded runs."""

import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.common.grid import OccupancyGrid
from sim.numerics.float_array import FloatArray
from tests.bench.robots.recorded_run import Run, write_for_peer

AMCL_SOURCES = [
    "pf/pf.c", "pf/eig3.c", "pf/pf_kdtree.c", "pf/pf_pdf.c", "pf/pf_vector.c", "map/map.c", "map/map_range.c",
    "map/map_cspace.cpp", "sensors/amcl_sensor.cpp", "sensors/amcl_laser.cpp", "sensors/amcl_odom.cpp",
]  # fmt: skip
SETTLED = 5
"""Updates after which the first uncertainty is over."""
NONE: FloatArray = np.empty(0)


@dataclass(frozen=True, slots=True)
class Tracked:
    """What a filter made of a run: meters off at each update, and CPU seconds of each.

    Of ours also whether the reported 95 % ellipse held the truth, and whether it said it was lost.
    """

    errors: FloatArray
    seconds: FloatArray
    covered: FloatArray
    lost: FloatArray


def build_amcl(package: Path, folder: Path) -> Path:
    """ROS's filter, built in a folder from its sources as ROS builds it for release."""
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


def run_peer(
    peer: Path, run: Run, grid: OccupancyGrid, folder: Path, model: str, particles: tuple[int, int],
    seed: int, known: bool,
) -> Tracked:  # fmt: skip
    drawn, log = write_for_peer(run, grid, folder)
    start = [str(value) for value in run.truth[0]] if known else ["global"]
    words = [peer, drawn, log, model, *particles, seed, *start]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True)
    table = np.array([line.split() for line in done.stdout.splitlines()], dtype=np.float64)
    off = table[:, 1:3] - run.truth[table[:, 0].astype(int), :2]
    return Tracked(np.hypot(*off.T), table[:, 5] * 1e-6, NONE, NONE)
