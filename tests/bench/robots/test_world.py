"""How fast the world and its sensors are, beams beside numpy."""

from pathlib import Path

import numpy as np
import pytest

from sim.common.grid import OccupancyGrid
from sim.common.raycast import Raycaster
from sim.numerics.float_array import FloatArray
from sim.parameters import WorldParameters
from sim.world.physics import World, WorldState
from sim.world.sensors import Sensors
from tests.bench.budget import Budgets, best
from thbridge.files.map_files import Map, read_map

pytestmark = pytest.mark.bench

ARENA = Path(__file__).parents[3] / "maps" / "arena8"


@pytest.fixture(scope="module")
def arena() -> Map:
    return read_map(ARENA)


def sampled_ranges(grid: OccupancyGrid, poses: FloatArray, angles: FloatArray, max_range: float) -> FloatArray:
    """The peer: numpy looks at every tenth of a cell along every beam."""
    along = np.arange(0.0, max_range, grid.resolution / 10)
    bearings = poses[:, 2, np.newaxis] + angles
    rays = np.stack((np.cos(bearings), np.sin(bearings)), axis=-1)
    out = np.empty(bearings.shape)
    for i, pose in enumerate(poses):
        points = pose[:2] + along[:, np.newaxis] * rays[i][:, np.newaxis]
        cells = grid.cells_of(points.reshape(-1, 2))
        cells = np.clip(cells, 0, np.array(grid.cells.shape) - 1)
        hit = grid.cells[cells[:, 0], cells[:, 1]].reshape(points.shape[:2]) == 100
        out[i] = np.where(hit.any(axis=1), along[hit.argmax(axis=1)], np.inf)
    return out


def test_beams_against_numpy(arena: Map, budgets: Budgets, capsys: pytest.CaptureFixture[str]) -> None:
    poses = np.array([room.goal.array() for room in arena.rooms])
    angles = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    raycaster = Raycaster.of(arena.grid)
    ours, peers = raycaster.ranges(poses, angles, 12.0), sampled_ranges(arena.grid, poses, angles, 12.0)
    seen = np.isfinite(ours) & np.isfinite(peers)
    # A sample may step over a corner, but it cannot see through a wall.
    assert np.median(np.abs(ours[seen] - peers[seen])) < arena.grid.resolution / 10
    fast = best(lambda: [raycaster.ranges(poses, angles, 12.0) for _ in range(50)], 5) / 50
    slow = best(lambda: sampled_ranges(arena.grid, poses, angles, 12.0), 3)
    with capsys.disabled():
        print(f"\n360 beams: {fast / len(poses) * 1e3:.3f} ms; {slow / fast:.0f} times as fast as numpy sampling")
    budgets.time("beams: 50 times 360 beams from each room of arena8", 50 * fast)


@pytest.mark.parametrize("robots", [2, 10])
def test_the_world_and_its_sensors(
    arena: Map, robots: int, budgets: Budgets, capsys: pytest.CaptureFixture[str]
) -> None:
    world = World(arena.grid, WorldParameters(), 1, 100.0)
    sensors = Sensors(arena.grid, WorldParameters(), 1, 100.0)
    begin = world.start((*arena.starts, *(room.goal for room in arena.rooms))[:robots])
    assert isinstance(begin, WorldState)
    commands = np.random.default_rng(0).uniform((-0.2, -1.0), (1.0, 1.0), (20, robots, 2))

    def drive(sensing: bool) -> None:
        state = begin
        for command in commands:
            for _ in range(25):
                state = world.step(state, command)
                if sensing:
                    for robot in range(robots):
                        sensors.sense(state, robot)

    simulated = 10.0
    moving = best(lambda: drive(sensing=False), 3)
    all_of_it = best(lambda: drive(sensing=True), 3)
    with capsys.disabled():
        print(
            f"\n{robots} robots: {simulated / all_of_it:.0f} simulated seconds per CPU second,"
            f" {all_of_it / simulated / robots * 1e3:.2f} ms per robot and second;"
            f" a step of the world {moving / 500 * 1e6:.0f} us"
        )
    budgets.time(f"world: a simulated second without sensors, {robots} robots", moving / simulated)
    budgets.time(f"world: a simulated second with sensors, {robots} robots", all_of_it / simulated)
