import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.raycast import BeamFan, Raycaster, directions_of, shorten_by_polygon, shorten_fan_by_polygon
from sim.numerics.float_array import FloatArray

ORIGINS = st.builds(Pose2, st.floats(-20, 20), st.floats(-20, 20), st.floats(-math.pi, 3.14))
SEEDS = st.integers(0, 2**32 - 1)


def random_grid(rng: np.random.Generator, origin: Pose2, density: float = 0.05) -> OccupancyGrid:
    rows, cols = rng.integers(1, 40, size=2)
    cells = rng.choice([0, 100, -1, 50], size=(rows, cols), p=[0.8 - density, density, 0.1, 0.1])
    return OccupancyGrid(cells.astype(np.int8), 0.05, origin)


def random_poses(rng: np.random.Generator, grid: OccupancyGrid, n: int) -> FloatArray:
    """Anywhere in the grid and half its size around it, in the map frame."""
    size = np.array([grid.cols, grid.rows]) * grid.resolution
    points = grid.origin.transform(rng.uniform(-0.5, 1.5, (n, 2)) * size)
    return np.column_stack((points, rng.uniform(-math.pi, math.pi, n)))


def one_beam(grid: OccupancyGrid, x: float, y: float, angle: float, max_range: float = 100.0) -> float:
    return float(Raycaster.of(grid).ranges(np.array([[x, y, 0.0]]), np.array([angle]), max_range)[0, 0])


def room() -> OccupancyGrid:
    """4 m by 2 m in cells of 0.1 m with walls one cell thick, its inner corner at (0.1, 0.1)."""
    cells = np.full((20, 40), 100, dtype=np.int8)
    cells[1:-1, 1:-1] = 0
    return OccupancyGrid(cells, 0.1, Pose2(0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("angle", "expected"),
    [
        (0.0, 2.9),
        (math.pi, 0.9),
        (math.pi / 2, 0.9),
        (-math.pi / 2, 0.9),
        (math.pi / 4, 0.9 * math.sqrt(2)),
        (math.atan2(0.9, 2.9), math.hypot(0.9, 2.9)),
    ],
)
def test_ranges_in_a_room_are_those_of_plane_geometry(angle: float, expected: float) -> None:
    assert one_beam(room(), 1.0, 1.0, angle) == pytest.approx(expected, abs=1e-12)


@given(SEEDS, ORIGINS)
@settings(max_examples=settings.default.max_examples // 2, deadline=None)
def test_a_beam_ends_exactly_where_it_first_meets_an_occupied_cell(seed: int, origin: Pose2) -> None:
    rng = np.random.default_rng(seed)
    grid = random_grid(rng, origin)
    poses = random_poses(rng, grid, 4)
    angles = rng.uniform(-math.pi, math.pi, 8)
    max_range = float(rng.uniform(0.2, 3.0))
    ranges = Raycaster.of(grid).ranges(poses, angles, max_range)
    along = np.arange(0.0, max_range, 0.002)
    for pose, row in zip(poses, ranges, strict=True):
        for angle, reach in zip(angles + pose[2], row, strict=True):
            ray = np.array([math.cos(angle), math.sin(angle)])

            def occupied(distances: FloatArray, pose: FloatArray = pose, ray: FloatArray = ray) -> bool:
                points = pose[:2] + distances[:, np.newaxis] * ray
                return any(grid.value_at(x, y) == 100 for x, y in points)

            assert not occupied(along[along < reach - 1e-9])
            if math.isfinite(reach):
                assert reach <= max_range
                assert occupied(np.array([reach + 1e-9]))


@given(SEEDS, ORIGINS)
def test_skipping_free_squares_changes_no_bit_of_a_range(seed: int, origin: Pose2) -> None:
    rng = np.random.default_rng(seed)
    grid = random_grid(rng, origin, density=float(rng.choice([0.0, 0.005, 0.05, 0.3])))
    poses = random_poses(rng, grid, 20)
    # Beams along the axes and diagonals, from cell corners too: where a step and a skip could round differently.
    corners = grid.origin.transform(rng.integers(-3, 43, (20, 2)) * grid.resolution)
    poses = np.vstack((poses, np.column_stack((corners, np.full(20, origin.theta)))))
    angles = np.concatenate((rng.uniform(-math.pi, math.pi, 20), np.arange(-4, 5) * math.pi / 4))
    skipping = Raycaster.of(grid)
    stepping = Raycaster(np.tile(grid.cells != 100, (4, 1, 1)).astype(np.uint8), grid.frame)
    assert np.array_equal(skipping.ranges(poses, angles, 5.0), stepping.ranges(poses, angles, 5.0))


@given(SEEDS, st.sampled_from([0.02, 0.05, 0.1, 1.0]))
def test_beams_through_cell_corners_skip_and_step_alike(seed: int, resolution: float) -> None:
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((60, 60)) < 0.01, 100, 0).astype(np.int8)
    grid = OccupancyGrid(cells, resolution, Pose2(*rng.integers(-9, 9, 2).tolist(), 0.0))
    corners = grid.origin.transform(rng.integers(0, 60, (50, 2)) * resolution)
    poses = np.column_stack((corners, np.zeros(50)))
    ways = rng.integers(-5, 6, (50, 2))
    angles = np.arctan2(ways[:, 0], ways[:, 1])
    skipping = Raycaster.of(grid)
    stepping = Raycaster(np.tile(grid.cells != 100, (4, 1, 1)).astype(np.uint8), grid.frame)
    max_range = 100 * resolution
    assert np.array_equal(skipping.ranges(poses, angles, max_range), stepping.ranges(poses, angles, max_range))


@given(SEEDS, ORIGINS)
def test_ranges_do_not_change_when_map_and_sensor_are_moved_together(seed: int, origin: Pose2) -> None:
    rng = np.random.default_rng(seed)
    grid = random_grid(rng, Pose2(0.0, 0.0, 0.0))
    moved = OccupancyGrid(grid.cells, grid.resolution, origin)
    poses = random_poses(rng, grid, 4)
    moved_poses = np.array([origin.compose(Pose2(*pose)).array() for pose in poses.tolist()])
    angles = rng.uniform(-math.pi, math.pi, 16)
    here = Raycaster.of(grid).ranges(poses, angles, 3.0)
    there = Raycaster.of(moved).ranges(moved_poses, angles, 3.0)
    assert there == pytest.approx(here, abs=1e-9)


def test_unknown_and_undecided_cells_let_beams_pass() -> None:
    cells = np.array([[0, -1, 50, 99, 100]], dtype=np.int8)
    assert one_beam(OccupancyGrid(cells, 1.0, Pose2(0, 0, 0)), 0.5, 0.5, 0.0) == pytest.approx(3.5)


def test_a_beam_in_a_wall_has_no_range() -> None:
    assert one_beam(room(), 0.05, 1.0, 0.0) == 0.0


def test_a_beam_from_outside_enters_the_map() -> None:
    assert one_beam(room(), -3.0, 1.0, 0.0) == pytest.approx(3.0)
    assert one_beam(room(), -3.0, 1.0, math.pi) == math.inf
    assert one_beam(room(), -3.0, -0.1, 0.0) == math.inf


def test_a_map_without_walls_stops_nothing() -> None:
    empty = OccupancyGrid(np.zeros((300, 600), dtype=np.int8), 0.05, Pose2(0, 0, 0))
    assert one_beam(empty, 1.0, 1.0, 0.3) == math.inf


def test_what_is_beyond_max_range_is_not_seen() -> None:
    assert one_beam(room(), 1.0, 1.0, 0.0, max_range=2.91) == pytest.approx(2.9)
    assert one_beam(room(), 1.0, 1.0, 0.0, max_range=2.89) == math.inf


def test_a_beam_without_end_is_refused() -> None:
    with pytest.raises(ValueError, match="max_range must be finite"):
        one_beam(room(), 1.0, 1.0, 0.0, max_range=math.inf)


def test_a_pose_that_is_not_a_number_ends_in_no_range() -> None:
    assert one_beam(room(), math.nan, 1.0, 0.0) == math.inf
    assert one_beam(room(), 1.0, 1.0, math.nan) == math.inf


@given(SEEDS)
@settings(max_examples=20, deadline=None)
def test_free_squares_are_the_largest_there_are(seed: int) -> None:
    rng = np.random.default_rng(seed)
    grid = random_grid(rng, Pose2(0.0, 0.0, 0.0))
    # All is free around the grid.
    walls = np.pad(grid.cells == 100, 300)
    squares = Raycaster.of(grid).squares
    for row, col in np.ndindex(*grid.cells.shape):
        for quadrant, (rows_up, cols_up) in enumerate(((False, False), (False, True), (True, False), (True, True))):
            side = int(squares[quadrant, row, col])

            def free(
                side: int, row: int = row + 300, col: int = col + 300, up: tuple[bool, bool] = (rows_up, cols_up)
            ) -> bool:
                rows = slice(row, row + side) if up[0] else slice(row - side + 1, row + 1)
                cols = slice(col, col + side) if up[1] else slice(col - side + 1, col + 1)
                return not walls[rows, cols].any()

            assert free(side) and (side == 255 or not free(side + 1))


def polygon_ranges(polygon: FloatArray, angles: FloatArray, max_range: float = 100.0) -> FloatArray:
    ranges = np.full(angles.size, math.inf)
    shorten_by_polygon(polygon, directions_of(angles), max_range, ranges)
    return ranges


@given(SEEDS, st.floats(0.01, 2 * math.pi), st.integers(2, 400))
def test_the_beams_of_a_fan_that_may_meet_a_polygon_are_all_that_do(seed: int, view: float, beams: int) -> None:
    rng = np.random.default_rng(seed)
    middle = rng.normal(0.0, rng.choice([0.1, 1.0, 5.0]), 2)
    polygon = middle + rng.normal(0.0, 0.3, (rng.integers(3, 6), 2))
    fan_angles = -0.5 * view + view / (beams - 1) * np.arange(beams)
    fan = BeamFan(-0.5 * view, view / (beams - 1), directions_of(fan_angles))
    ranges = np.full(beams, math.inf)
    shorten_fan_by_polygon(polygon, fan, 8.0, ranges)
    assert np.array_equal(ranges, polygon_ranges(polygon, fan_angles, 8.0))


SQUARE = np.array([[2.0, -1.0], [4.0, -1.0], [4.0, 1.0], [2.0, 1.0]])


def test_a_polygon_is_seen_at_its_nearest_edge() -> None:
    angles = np.array([0.0, math.atan2(0.999, 2.0), math.atan2(1.001, 2.0), math.pi, math.pi / 2])
    expected = [2.0, math.hypot(0.999, 2.0), math.inf, math.inf, math.inf]
    assert polygon_ranges(SQUARE, angles) == pytest.approx(np.array(expected))


def test_a_polygon_behind_a_wall_or_too_far_changes_nothing() -> None:
    ranges = np.array([1.5])
    shorten_by_polygon(SQUARE, np.array([[1.0, 0.0]]), 100.0, ranges)
    assert ranges[0] == 1.5
    assert polygon_ranges(SQUARE, np.zeros(1), max_range=1.9)[0] == math.inf


def test_a_notch_can_be_looked_into() -> None:
    notched = np.array([[2.0, -1.0], [4.0, -1.0], [4.0, 1.0], [2.0, 1.0], [3.0, 0.0]])
    assert polygon_ranges(notched, np.zeros(1))[0] == pytest.approx(3.0)


def test_a_sensor_inside_sees_the_outline_from_within() -> None:
    assert polygon_ranges(SQUARE - [3.0, 0.0], np.array([0.0, math.pi])) == pytest.approx(np.ones(2))


def test_no_beam_slips_through_a_corner() -> None:
    # The beam runs along y = 0 through a corner that two edges share.
    diamond = np.array([[3.0, -1.0], [4.0, 0.0], [3.0, 1.0], [2.0, 0.0]])
    assert polygon_ranges(diamond, np.zeros(1))[0] == pytest.approx(2.0)


@given(SEEDS, st.integers(3, 9))
@settings(max_examples=50, deadline=None)
def test_polygons_agree_with_the_same_shape_drawn_by_sampling(seed: int, corners: int) -> None:
    rng = np.random.default_rng(seed)
    around = np.sort(rng.uniform(-math.pi, math.pi, corners))
    star = np.column_stack((np.cos(around), np.sin(around))) * rng.uniform(0.2, 1.0, (corners, 1))
    polygon = star + rng.uniform(-3, 3, 2)
    angles = rng.uniform(-math.pi, math.pi, 16)
    ranges = polygon_ranges(polygon, angles)
    nearest = np.full(16, math.inf)
    for j, angle in enumerate(angles):
        for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            # Solve origin + t * ray = a + u * (b - a).
            matrix = np.column_stack(([math.cos(angle), math.sin(angle)], a - b))
            t, u = np.linalg.solve(matrix, a)
            if t >= 0 and 0 <= u <= 1:
                nearest[j] = min(nearest[j], t)
    assert ranges == pytest.approx(nearest, abs=1e-9)
