import math
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.polygons import placed_at
from sim.inputs import PutThing, RemoveThing, ScheduledInput
from sim.parameters import RobotParameters, WorldParameters
from sim.robot.local_planning.braking import gap
from sim.world.physics import Misplaced
from sim.world.thing import Thing
from thbridge.files.map_files import read_map
from thbridge.offline.drive import DriveResult, DriveTask, _to_squares, drive

OFFICE = read_map(Path(__file__).parents[3] / "maps" / "office")


def two_rooms(origin=Pose2(0.0, 0.0, 0.0)):  # noqa: B008 - frozen
    """6 m x 4 m, a wall across the middle with a door of 1.1 m."""
    cells = np.zeros((80, 120), np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    cells[:29, 60:62] = cells[51:, 60:62] = 100
    return OccupancyGrid(cells, 0.05, origin)


def errand(start, goal, any_heading=True, timeout=60.0):
    return DriveTask(Pose2(*start), Pose2(*goal), any_heading, timeout)


def driven(grid, task, seed=1) -> DriveResult:
    outcome = drive(grid, WorldParameters(), RobotParameters(), task, seed)
    assert isinstance(outcome, DriveResult)
    return outcome


THROUGH = errand((1.0, 1.0, 0.0), (5.0, 3.0, 0.0))


def test_a_door_of_a_metre_and_a_tenth_is_passed() -> None:
    outcome = driven(two_rooms(), THROUGH)
    assert (outcome.reached, outcome.collided, outcome.reason) == (True, False, None)
    assert math.hypot(4.0, 2.0) - 0.1 < outcome.distance < 1.3 * math.hypot(4.0, 2.0)
    # The door leaves 0.3 m on each side of the body, the localization errs by some centimeters.
    assert 0.05 < outcome.min_clearance <= 0.301
    assert outcome.seconds < 15.0


def test_the_same_seed_gives_the_same_drive() -> None:
    assert driven(two_rooms(), THROUGH, seed=3) == driven(two_rooms(), THROUGH, seed=3)
    assert driven(two_rooms(), THROUGH, seed=3) != driven(two_rooms(), THROUGH, seed=4)


def test_a_map_that_is_turned_is_driven_on_as_if_it_were_not() -> None:
    origin = Pose2(-3.0, 2.0, 0.7)
    turned = DriveTask(origin.compose(THROUGH.start), origin.compose(THROUGH.goal), any_heading=True, timeout=60.0)
    straight, aslant = driven(two_rooms(), THROUGH), driven(two_rooms(origin), turned)
    assert aslant.reached
    assert aslant.distance == pytest.approx(straight.distance, abs=0.1)


def test_a_heading_at_the_goal_takes_its_time() -> None:
    any_heading = driven(two_rooms(), errand((1.0, 2.0, 0.0), (2.0, 2.0, 3.0)))
    turned = driven(two_rooms(), errand((1.0, 2.0, 0.0), (2.0, 2.0, 3.0), any_heading=False))
    assert any_heading.reached
    assert turned.reached
    assert turned.seconds > any_heading.seconds + 2.0


def test_a_goal_that_cannot_be_reached_is_given_up_with_its_reason() -> None:
    outcome = driven(two_rooms(), errand((1.0, 1.0, 0.0), (3.05, 0.5, 0.0)))
    assert not outcome.reached
    assert outcome.seconds < 1.0
    assert "wall" in str(outcome.reason)


@pytest.mark.parametrize(
    ("start", "goal", "told"),
    [
        ((1.0, 1.0), (5.0, 0.02), "the goal lies in the map's outermost row or column of cells"),
        ((1.0, 0.02), (5.0, 1.0), "the robot stands in the map's outermost row or column of cells"),
        ((1.0, 1.0), (5.0, 0.2), "; the goal lies 0.20 m from the map's edge, which is nearer than the body's radius"),
    ],
)
def test_ends_at_the_edge_of_a_map_are_named(start, goal, told) -> None:
    """Two rooms that go on to the map's edge, with a wall without a door between them."""
    cells = np.zeros((40, 120), np.int8)
    cells[:, 60] = 100
    outcome = driven(OccupancyGrid(cells, 0.05, Pose2(0.0, 0.0, 0.0)), errand((*start, 0.0), (*goal, 0.0)))
    assert told in str(outcome.reason)


def test_a_robot_that_is_too_slow_is_still_under_way() -> None:
    outcome = driven(two_rooms(), errand((1.0, 1.0, 0.0), (5.0, 3.0, 0.0), timeout=2.0))
    assert (outcome.reached, outcome.seconds) == (False, 2.0)
    assert "under way" in str(outcome.reason)


def test_a_start_in_a_wall_is_named() -> None:
    outcome = drive(two_rooms(), WorldParameters(), RobotParameters(), errand((3.0, 0.5, 0.0), (5.0, 3.0, 0.0)), 1)
    assert isinstance(outcome, Misplaced)
    assert outcome.reason == "wall"


def test_clearance_is_that_of_the_outline_from_the_sides_of_cells() -> None:
    rng = np.random.default_rng(2)
    body = np.array(WorldParameters().footprint)
    for _ in range(50):
        centres, half = rng.uniform(-1.0, 1.0, (6, 2)), 0.025
        centres += 0.6 * np.sign(centres)
        at = placed_at(body, *rng.uniform(-0.2, 0.2, 2), rng.uniform(-3.0, 3.0))
        squares = centres[:, np.newaxis] + half * np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)])
        assert _to_squares(at, centres, half) == pytest.approx(min(gap(at, square) for square in squares))


def boxed(grid: OccupancyGrid, *boxes: tuple[int, int, int, int]) -> OccupancyGrid:
    """The map with boxes of rows and columns that the robot does not know."""
    cells = grid.cells.copy()
    for top, bottom, left, right in boxes:
        cells[top:bottom, left:right] = 100
    return OccupancyGrid(cells, grid.resolution, grid.origin)


def test_an_obstacle_that_the_map_does_not_show_is_seen_and_gone_round() -> None:
    grid = two_rooms()
    box = boxed(grid, (17, 33, 30, 36))
    straight = errand((0.6, 1.2, 0.0), (2.6, 1.2, 0.0))
    free = driven(grid, straight)
    outcome = drive(grid, WorldParameters(), RobotParameters(), straight, 1, box)
    assert isinstance(outcome, DriveResult)
    assert (outcome.reached, outcome.collided) == (True, False)
    assert outcome.distance > free.distance + 0.2
    assert 0.0 < outcome.min_clearance < 0.3


def test_an_unknown_obstacle_in_the_only_door_leaves_no_way() -> None:
    grid = two_rooms()
    shut = boxed(grid, (25, 55, 60, 62))
    outcome = drive(grid, WorldParameters(), RobotParameters(), THROUGH, 1, shut)
    assert isinstance(outcome, DriveResult)
    assert (outcome.reached, outcome.collided) == (False, False)
    assert outcome.seconds > 3.0


@pytest.mark.parametrize("origin", [Pose2(0.0, 0.0, 0.0), Pose2(-3.0, 2.0, 0.7)], ids=["straight", "turned"])
def test_what_comes_and_goes_is_waited_for(origin: Pose2) -> None:
    """Also on a map that is turned: places of obstacles are in its frame."""
    task = DriveTask(*(origin.compose(Pose2(x, 1.2, 0.0)) for x in (0.6, 2.4)), any_heading=True, timeout=60.0)
    alone = driven(two_rooms(origin), task)
    corners = ((0.05, 1.9), (-0.05, 1.9), (-0.05, -1.9), (0.05, -1.9))
    barrier = PutThing(Thing("barrier", corners, origin.compose(Pose2(1.6, 2.0, 0.0))))
    schedule = [ScheduledInput(0, barrier), ScheduledInput(300, RemoveThing("barrier"))]
    outcome = drive(two_rooms(origin), WorldParameters(), RobotParameters(), task, 1, None, schedule)
    assert isinstance(outcome, DriveResult)
    assert (outcome.reached, outcome.collided) == (True, False)
    assert outcome.seconds > alone.seconds + 1.0


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_the_tour_of_the_office_is_driven_from_room_to_room(seed: int) -> None:
    here = OFFICE.starts[0]
    for number in (1, 8, 2, 7, 3, 5, 6, 4):
        goal = OFFICE.rooms[number - 1].goal
        outcome = driven(OFFICE.grid, DriveTask(here, goal, any_heading=False, timeout=120.0), seed)
        assert (outcome.reached, outcome.collided) == (True, False)
        here = goal
