"""Ray casting as others measure it: 360 beams of 10 m on 500 x 300 cells of 0.1 m; prints scans per CPU second."""

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import Cells, OccupancyGrid
from sim.common.raycast import Raycaster
from tests.bench.budget import Budgets, best

pytestmark = pytest.mark.bench

ROWS, COLS, RESOLUTION = 300, 500, 0.1
MAZE_PITCH = 10


def hall() -> Cells:
    cells = np.full((ROWS, COLS), 100, dtype=np.int8)
    cells[1:-1, 1:-1] = 0
    return cells


def boxes() -> Cells:
    """A hall with 60 boxes of 0.3 to 2 m."""
    chance, cells = np.random.default_rng(0), hall()
    for _ in range(60):
        row, col = chance.integers(5, 280), chance.integers(5, 480)
        height, width = chance.integers(3, 20, 2)
        cells[row : row + height, col : col + width] = 100
    return cells


def office() -> Cells:
    """Two corridors between rows of rooms of 5 m, with doors of 1.1 m."""
    cells = hall()
    for wall in (100, 130, 170, 200):
        cells[wall] = 100
    for col in range(0, COLS, 50):
        for first, last in ((1, 100), (131, 170), (201, ROWS)):
            cells[first:last, col] = 100
        for wall in (100, 130, 170, 200):
            cells[wall, col + 20 : col + 31] = 0
    return cells


def cluttered() -> Cells:
    """Every hundredth cell is occupied."""
    cells = hall()
    cells[np.random.default_rng(1).random(cells.shape) < 0.01] = 100
    return cells


def maze() -> Cells:
    """Passages of 0.8 m between walls of 0.2 m, one way from each place to each other."""
    chance = np.random.default_rng(2)
    cells = np.full((ROWS, COLS), 100, dtype=np.int8)
    seen = np.zeros((ROWS // MAZE_PITCH - 1, COLS // MAZE_PITCH - 1), dtype=bool)
    trail = [(0, 0)]
    seen[0, 0] = True
    while trail:
        row, col = trail[-1]
        around = [(row + 1, col), (row - 1, col), (row, col + 1), (row, col - 1)]
        ways = [(r, c) for r, c in around if 0 <= r < seen.shape[0] and 0 <= c < seen.shape[1] and not seen[r, c]]
        if not ways:
            trail.pop()
            continue
        step = ways[chance.integers(len(ways))]
        seen[step] = True
        trail.append(step)
        top, left = min(row, step[0]) * MAZE_PITCH + 2, min(col, step[1]) * MAZE_PITCH + 2
        bottom, right = (max(row, step[0]) + 1) * MAZE_PITCH, (max(col, step[1]) + 1) * MAZE_PITCH
        cells[top:bottom, left:right] = 0
    return cells


@pytest.mark.parametrize("draw", [hall, boxes, office, cluttered, maze])
def test_scans_per_second(draw, budgets: Budgets, capsys):
    cells = draw()
    raycaster = Raycaster.of(OccupancyGrid(cells, RESOLUTION, Pose2(0.0, 0.0, 0.0)))
    chance = np.random.default_rng(3)
    free = np.argwhere(cells == 0)
    chosen = free[chance.integers(0, len(free), 500)]
    places = (chosen[:, ::-1] + chance.random((500, 2))) * RESOLUTION
    poses = np.column_stack((places, chance.uniform(-np.pi, np.pi, 500)))
    angles = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    spent = best(lambda: raycaster.ranges(poses, angles, 10.0), 7)
    with capsys.disabled():
        print(f"\n{draw.__name__:>10}: {500 / spent:8.0f} scans of 360 beams per CPU second")
    budgets.time(f"beams: 500 scans of 360 beams, {draw.__name__}", spent)
