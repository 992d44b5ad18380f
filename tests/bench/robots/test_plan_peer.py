"""Our navfn beside ROS's own, on the same costmap and queries in the same minute.

ROS's stands beside ours only with a checkout of github.com/ros-planning/navigation: `NAVIGATION_SRC=/path make bench`.
"""

import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sim.common.geometry import Pose2
from sim.parameters import InflationParameters, NavfnParameters, StaticParameters
from sim.robot.costmap.costs import CostFrame, Costs, Window
from sim.robot.costmap.inflation import InflationLayer
from sim.robot.costmap.static import interpretation
from sim.robot.global_planning.navfn import Navfn
from sim.robot.global_planning.path import Path as Way
from sim.robot.global_planning.potential_planner import PotentialPlanner
from tests.bench.budget import best

pytestmark = pytest.mark.bench

TIMES = 7
RESOLUTION = 0.05


@pytest.fixture(scope="session")
def peer(navigation, tmp_path_factory) -> Path | None:
    """navfn, built as ROS builds it for release, with its log of ROS left out; None without its source."""
    if navigation is None:
        return None
    folder = tmp_path_factory.mktemp("navfn")
    (folder / "ros").mkdir()
    log = "\n".join(f"#define ROS_{level}(...)" for level in ("DEBUG", "INFO", "WARN", "ERROR"))
    (folder / "ros" / "console.h").write_text(log + "\n")
    program = folder / "navfn_peer"
    source = navigation / "navfn"
    main = Path(__file__).parent / "peers" / "navfn_peer.cpp"
    flags = ["-O3", "-DNDEBUG", f"-I{folder}", f"-I{source / 'include'}"]
    subprocess.run(["g++", *flags, main, source / "src" / "navfn.cpp", "-o", program], check=True)
    return program


@pytest.fixture(scope="session")
def costs(office) -> Costs:
    """The office as a robot of 0.2 m inscribed radius sees it, with costmap_2d's default inflation."""
    layer = InflationLayer(InflationParameters(), RESOLUTION, 0.2)
    walls = interpretation(StaticParameters())[office.grid.cells.view(np.uint8)]
    layer.write(walls, (0, 0), Window(0, 0, *walls.shape))
    return walls


def mixed(costs: Costs) -> NDArray[np.int32]:
    """Sixty pairs of places: (n, 4) start column and row, goal column and row."""
    places = np.argwhere(costs < 128)[:, ::-1]
    return places[np.random.default_rng(1).integers(0, len(places), (60, 2))].reshape(-1, 4).astype(np.int32)


def longest(costs: Costs) -> NDArray[np.int32]:
    """From one end to the other, twenty times."""
    places = np.argwhere(costs < 128)[:, ::-1]
    first, last = places[places.sum(axis=1).argmin()], places[places.sum(axis=1).argmax()]
    return np.tile(np.concatenate((first, last)), (20, 1)).astype(np.int32)


def theirs(peer: Path, costs: Costs, queries: NDArray[np.int32], mode: str, folder: Path) -> tuple[float, float]:
    """Milliseconds a query, the best of several runs, and meters of all paths."""
    file = folder / "queries"
    file.write_bytes(struct.pack("<iii", *costs.shape, len(queries)) + costs.tobytes() + queries.tobytes())
    tables = []
    for _ in range(TIMES):
        done = subprocess.run([peer, file, mode], capture_output=True, text=True, check=True)
        tables.append(np.array([line.split() for line in done.stdout.splitlines()], dtype=np.float64))
    return min(table[:, 2].mean() for table in tables) / 1e3, tables[0][:, 1].sum() * RESOLUTION


def ours(costs: Costs, queries: NDArray[np.int32], mode: str) -> tuple[float, float]:
    frame = CostFrame(0.0, 0.0, RESOLUTION)
    method = Navfn(NavfnParameters(use_astar=mode == "astar"))
    planner = PotentialPlanner(method)
    ends = [
        tuple(Pose2((col + 0.5) * RESOLUTION, (row + 0.5) * RESOLUTION, 0.0) for col, row in (query[:2], query[2:]))
        for query in queries.tolist()
    ]
    lengths = []

    def plan() -> None:
        length = 0.0
        for start, goal in ends:
            if mode == "whole":
                planner.potential(costs, frame, start)
            else:
                way = planner.plan(costs, frame, start, goal)
                length += way.length if isinstance(way, Way) else 0.0
        lengths.append(length)

    return 1e3 * best(plan, TIMES) / len(queries), lengths[-1]


@pytest.mark.parametrize(
    ("mode", "queries"),
    [("dijkstra", mixed), ("astar", mixed), ("dijkstra", longest), ("astar", longest), ("whole", longest)],
)
def test_plans(mode, queries, peer, costs, budgets, tmp_path, capsys):
    asked = queries(costs)
    mine, my_length = ours(costs, asked, mode)
    what = f"navfn: {mode}, {queries.__name__} queries"
    told = f"\n{mode:>9}, {queries.__name__:>7}: ours {mine:5.2f} ms"
    if peer is not None:
        other, their_length = theirs(peer, costs, asked, mode, tmp_path)
        told += f", navfn {other:5.2f} ms, ratio {mine / other:.2f}; length of all paths {my_length:.1f}"
        told += f" and {their_length:.1f} m"
        assert mode == "whole" or my_length == pytest.approx(their_length, abs=0.1)
        budgets.ratio(f"{what}, beside ROS's", mine / other)
    with capsys.disabled():
        print(told)
    budgets.time(what, 1e-3 * mine)
