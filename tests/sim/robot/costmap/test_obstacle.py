"""The obstacle layer: marking and clearing by the laser."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.observations import LaserMount, Scan
from sim.common.raycast import Raycaster
from sim.parameters import ObservationSource, ObstacleParameters, RobotParameters, WorldParameters
from sim.robot.costmap.costs import FREE, LETHAL, UNKNOWN, Window
from sim.robot.costmap.obstacle import CostmapObservation, ObstacleLayer

STUDY = np.array(WorldParameters().footprint)
HUNT = RobotParameters().global_costmap.obstacle_layer
NOBODY = np.empty((0, 3))
LASER = ObservationSource(marking=True, clearing=True, inf_is_valid=True)
ROS = ObstacleParameters(observation_sources=(LASER,), footprint_clearing_enabled=False)
MOUNT = LaserMount(Pose2(0.0, 0.0, 0.0), 0.0, 0.1, 1, 0.05, 8.0)
AHEAD = Pose2(0.0, 0.0, 0.0)


def grid_of(occupied=(), rows=60, cols=80):
    cells = np.zeros((rows, cols), np.int8)
    for row, col in occupied:
        cells[row, col] = 100
    return OccupancyGrid(cells, 0.05, Pose2(-1.0, -1.0, 0.0))


def layer_of(parameters=ROS, grid=None, **rest):
    return ObstacleLayer(parameters, grid or grid_of(), STUDY, **rest)


def scan(*readings, angle_min=0.0, increment=0.1):
    mount = LaserMount(Pose2(0.0, 0.0, 0.0), angle_min, increment, len(readings), 0.05, 8.0)
    return Scan(0, mount, np.array(readings, np.float32))


def lethal(layer):
    return {(int(r), int(c)) for r, c in zip(*np.nonzero(layer.marks == LETHAL), strict=True)}


class TestAsInRos:
    def test_a_reading_marks_the_cell_it_ends_in_and_a_longer_one_clears_it(self):
        layer = layer_of()
        layer.observe(CostmapObservation(AHEAD, scan(1.02), NOBODY))
        cell = grid_of().cell_of(1.02, 0.0)
        assert lethal(layer) == {cell}
        assert layer.bounds() == (Window(cell[0], cell[1], cell[0] + 1, cell[1] + 1),)
        layer.observe(CostmapObservation(AHEAD, scan(2.0), NOBODY))
        assert cell not in lethal(layer)

    @pytest.mark.parametrize("reading", [math.nan, math.inf, 2.5, 0.01, 9.0])
    def test_lost_empty_far_and_too_near_readings_do_not_mark(self, reading):
        layer = layer_of()
        layer.observe(CostmapObservation(AHEAD, scan(reading), NOBODY))
        assert not lethal(layer)

    @pytest.mark.parametrize(("inf_is_valid", "left"), [(True, False), (False, True)])
    def test_a_beam_that_hits_nothing_clears_if_that_is_valid(self, inf_is_valid, left):
        source = ObservationSource(clearing=True, inf_is_valid=inf_is_valid)
        layer = layer_of(ObstacleParameters(observation_sources=(source,)))
        layer.observe(CostmapObservation(AHEAD, scan(1.02), NOBODY))
        layer.observe(CostmapObservation(AHEAD, scan(math.inf), NOBODY))
        assert bool(lethal(layer)) == left

    def test_space_is_cleared_as_far_as_raytrace_range(self):
        layer = layer_of(ObstacleParameters(raytrace_range=1.0, observation_sources=(LASER,)))
        for reading in (0.92, 1.32):
            layer.observe(CostmapObservation(AHEAD, scan(math.nan, reading), NOBODY))
            layer.observe(CostmapObservation(AHEAD, scan(reading), NOBODY))
        layer.observe(CostmapObservation(AHEAD, scan(2.4), NOBODY))
        grid = grid_of()
        ahead = {cell for cell in lethal(layer) if cell[0] == grid.cell_of(0.0, 0.0)[0]}
        assert ahead == {grid.cell_of(1.32, 0.0), grid.cell_of(2.4, 0.0)}

    def test_without_sources_nothing_is_seen(self):
        layer = layer_of(ObstacleParameters())
        layer.observe(CostmapObservation(AHEAD, scan(1.0), NOBODY))
        assert not lethal(layer)

    def test_a_source_has_its_own_ranges_and_need_not_mark_or_clear(self):
        near = ObservationSource(obstacle_range=0.5)
        sweeper = ObservationSource(name="sweeper", marking=False, clearing=True, raytrace_range=0.3)
        layer = layer_of(ObstacleParameters(observation_sources=(near, sweeper), footprint_clearing_enabled=False))
        layer.observe(CostmapObservation(AHEAD, scan(0.42), NOBODY))
        layer.observe(CostmapObservation(AHEAD, scan(0.7), NOBODY))
        assert lethal(layer) == {grid_of().cell_of(0.42, 0.0)}

    def test_the_robots_own_place_is_free(self):
        layer = layer_of(ObstacleParameters(observation_sources=(LASER,)))
        layer.observe(CostmapObservation(AHEAD, scan(0.2), NOBODY))
        assert not lethal(layer)

    @pytest.mark.parametrize(
        ("method", "expected"),
        [(0, [LETHAL, FREE, 7]), (1, [LETHAL, LETHAL, 7]), (99, [5, LETHAL, 7])],
    )
    def test_costs_are_combined_as_told(self, method, expected):
        parameters = ObstacleParameters(
            combination_method=method,
            observation_sources=(LASER,),
            track_unknown_space=True,
            footprint_clearing_enabled=False,
        )
        layer = layer_of(parameters)
        layer.observe(CostmapObservation(AHEAD, scan(1.02), NOBODY))
        row, col = grid_of().cell_of(1.02, 0.0)
        costs = np.array([[5, LETHAL, 7]], np.uint8)
        # The cell before the mark was seen empty; of the one behind it nothing is known.
        layer.write(costs[:, :1], (row, col), Window(row, col, row + 1, col + 1))
        layer.write(costs[:, 1:2], (row, col - 1), Window(row, col - 1, row + 1, col))
        layer.write(costs[:, 2:], (row, col + 1), Window(row, col + 1, row + 1, col + 2))
        assert costs[0].tolist() == expected

    @pytest.mark.parametrize(
        ("own", "costmaps", "unseen"), [(None, True, UNKNOWN), (None, False, FREE), (False, True, FREE)]
    )
    def test_what_was_not_seen_is_unknown_or_free(self, own, costmaps, unseen):
        parameters = ObstacleParameters(track_unknown_space=own)
        assert (layer_of(parameters, track_unknown_space=costmaps).marks == unseen).all()


class TestThingsThatComeAndGo:
    """On a map with walls, with the settings of hunts, by a robot that errs about where it is."""

    grid = grid_of([(r, c) for r in range(160) for c in range(160) if r in (0, 159) or c in (0, 159)], 160, 160)
    beams = WorldParameters().laser.beams

    def see(self, layer, pose, things, error=(0.0, 0.0, 0.0)):
        """A scan of the walls and of things that are not on the map: lists of cells."""
        cells = self.grid.cells.copy()
        for row, col in things:
            cells[row, col] = 100
        laser = WorldParameters().laser
        increment = laser.field_of_view / (laser.beams - 1)
        mount = LaserMount(
            Pose2(laser.x, 0.0, 0.0), -laser.field_of_view / 2, increment, laser.beams, laser.range_min, laser.range_max
        )
        at = pose.compose(mount.laser_in_base)
        truth = OccupancyGrid(cells, self.grid.resolution, self.grid.origin)
        ranges = Raycaster.of(truth).ranges(at.array()[np.newaxis], mount.angles(), laser.range_max)[0]
        believed = Pose2(pose.x + error[0], pose.y + error[1], pose.theta + error[2])
        layer.observe(CostmapObservation(believed, Scan(0, mount, ranges.astype(np.float32)), NOBODY))

    @settings(max_examples=25, deadline=None)
    @given(st.floats(-0.05, 0.05), st.floats(-0.05, 0.05), st.floats(-0.03, 0.03))
    def test_walls_do_not_thicken_when_the_robot_errs(self, x, y, theta):
        layer = layer_of(HUNT, self.grid)
        self.see(layer, Pose2(0.0, 0.3, 0.4), [], (x, y, theta))
        assert not lethal(layer)

    @settings(max_examples=15, deadline=None)
    @given(st.floats(-0.07, 0.07), st.floats(-0.07, 0.07), st.floats(-0.02, 0.02))
    def test_a_crate_against_the_wall_is_marked_and_gone_when_it_is_taken_away(self, x, y, theta):
        layer = layer_of(HUNT, self.grid)
        crate = [(r, c) for r in range(1, 9) for c in range(30, 42)]
        pose = Pose2(0.8, 0.3, -1.5)
        self.see(layer, pose, crate, (x, y, theta))
        assert len(lethal(layer)) >= 8
        for _ in range(2):
            self.see(layer, pose, [], (-x, y, -theta))
        assert not lethal(layer)

    def test_a_person_who_walks_by_leaves_no_trail(self):
        layer = layer_of(HUNT, self.grid)
        pose = Pose2(1.0, 1.0, 0.0)
        rng = np.random.default_rng(2)
        for step in range(40):
            row, col = 20 + 2 * step, 60 + step // 8
            person = [(row + r, col + c) for r in range(6) for c in range(6)]
            error = rng.normal(0.0, (0.02, 0.02, 0.01))
            self.see(layer, pose, person, error)
            seen = lethal(layer)
            assert all(abs(r - row - 2.5) < 9 and abs(c - col - 2.5) < 9 for r, c in seen)
        self.see(layer, pose, [])
        assert not lethal(layer)

    def test_far_out_ros_leaves_what_lies_between_beams_and_we_need_not(self):
        mark = scan(math.nan, 2.4, math.nan, increment=0.1)
        gone = scan(5.0, 5.0, increment=0.2)
        for between, left in ((False, True), (True, False)):
            parameters = ObstacleParameters(
                observation_sources=(LASER,), clear_between_beams=between, footprint_clearing_enabled=False
            )
            layer = layer_of(parameters)
            layer.observe(CostmapObservation(AHEAD, mark, NOBODY))
            assert lethal(layer)
            layer.observe(CostmapObservation(AHEAD, gone, NOBODY))
            assert bool(lethal(layer)) == left

    def test_readings_near_another_robot_do_not_mark(self):
        layer = layer_of(HUNT)
        layer.observe(CostmapObservation(AHEAD, scan(0.6), np.array([[0.9, 0.0, 0.35]])))
        assert not lethal(layer)
        layer.observe(CostmapObservation(AHEAD, scan(0.6), NOBODY))
        assert lethal(layer)

    @pytest.mark.parametrize("reading", [0.6, 1.45])
    def test_only_robots_within_a_certain_distance_do_so(self, reading):
        layer, radius = layer_of(HUNT), 0.35
        farthest = layer.explained_range + radius
        layer.observe(CostmapObservation(AHEAD, scan(reading), np.array([[farthest + 0.001, 0.0, radius]])))
        assert lethal(layer)
        layer = layer_of(HUNT)
        layer.observe(CostmapObservation(AHEAD, scan(reading), np.array([[farthest - 0.06, 0.0, radius]])))
        assert bool(lethal(layer)) == (reading < 1.0)


def test_clearing_forgets_all_and_says_so():
    layer = layer_of()
    layer.observe(CostmapObservation(AHEAD, scan(1.0), NOBODY))
    layer.bounds()
    layer.clear()
    assert not lethal(layer)
    assert layer.bounds()


@given(st.lists(st.tuples(st.integers(0, 149), st.integers(0, 199)), max_size=6), st.booleans())
def test_all_that_is_marked_lies_in_its_extents_and_is_forgotten_when_it_is_cleared(cells, unknown):
    grid = OccupancyGrid(np.zeros((150, 200), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))
    layer = ObstacleLayer(ObstacleParameters(), grid, np.empty((0, 2)), track_unknown_space=unknown)
    blank = layer.marks.copy()
    assert layer.extents() == ()
    for row, col in cells:
        layer.marks[row, col] = LETHAL
    outside = layer.marks.copy()
    for window in layer.extents():
        window.of(outside)[:] = blank[0, 0]
    assert np.array_equal(outside, blank)
    layer.clear()
    assert np.array_equal(layer.marks, blank)


@given(
    st.lists(st.tuples(st.integers(0, 59), st.integers(0, 79)), max_size=20),
    st.floats(-2.0, 4.0),
    st.floats(-2.0, 3.0),
    st.floats(-0.5, 3.0),
)
def test_each_mark_is_either_inside_a_square_or_outside_of_it(cells, x, y, side):
    inside, outside = layer_of(), layer_of()
    for layer in (inside, outside):
        for row, col in cells:
            layer.marks[row, col] = LETHAL
    every = lethal(inside)
    inside.clear_outside(x, y, side)
    outside.clear_inside(x, y, side)
    assert lethal(inside) | lethal(outside) == every
    assert not lethal(inside) & lethal(outside)
    for row, col in lethal(inside):
        assert abs(-1.0 + 0.05 * (col + 0.5) - x) <= side / 2 + 0.025 + 1e-9
        assert abs(-1.0 + 0.05 * (row + 0.5) - y) <= side / 2 + 0.025 + 1e-9
    changed = outside.bounds()
    for row, col in every - lethal(outside):
        assert any(window.meets(Window(row, col, row + 1, col + 1)) for window in changed)


def test_a_rolling_layer_keeps_what_stays_in_its_window():
    layer = layer_of(shape=(20, 30))
    layer.roll((10, 10))
    layer.observe(CostmapObservation(Pose2(0.0, 0.0, 0.0), scan(0.42), NOBODY))
    cell = grid_of().cell_of(0.42, 0.0)
    assert lethal(layer) == {(cell[0] - 10, cell[1] - 10)}
    layer.roll((12, 25))
    assert lethal(layer) == {(cell[0] - 12, cell[1] - 25)}
    layer.roll((cell[0] + 1, 10))
    layer.roll((10, 10))
    assert not lethal(layer)
