import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import LaserMount, Scan
from sim.robot.navigator.scan_obstacles import may_turn, room_ahead, seen_around

MOUNT = LaserMount(Pose2(0.1, 0.0, 0.0), -2.35619449, 4.71238898 / 180, 181, 0.05, 8.0)


def wall_behind(distance):
    """Scan of an endless wall this far behind the base: the outermost beams alone end on it."""
    along = np.cos(MOUNT.angles())
    with np.errstate(divide="ignore"):
        ranges = np.where(along < 0, (distance + 0.1) / np.maximum(-along, 1e-9), np.inf)
    return Scan(0, MOUNT, ranges.astype(np.float32))


def test_room_to_turn_ends_at_a_wall_behind_that_the_laser_does_not_see():
    assert may_turn(wall_behind(0.5), 0.36)
    assert not may_turn(wall_behind(0.4), 0.36)


def test_nothing_seen_leaves_room():
    ranges = np.full(181, np.inf, np.float32)
    assert may_turn(Scan(0, MOUNT, ranges), 0.36)
    assert seen_around(Scan(0, MOUNT, ranges), 5).clearance.min() > 1.0


def test_what_is_seen_lies_where_it_is_seen_from_the_base():
    ranges = np.full(181, np.nan, np.float32)
    ranges[90] = 0.6
    around = seen_around(Scan(0, MOUNT, ranges), 5)
    row, col = np.unravel_index(np.argmin(around.clearance), around.clearance.shape)
    assert around.frame.x + (col + 0.5) * around.frame.resolution == pytest.approx(0.7, abs=0.03)
    assert around.frame.y + (row + 0.5) * around.frame.resolution == pytest.approx(0.0, abs=0.03)


def test_room_ahead_counts_what_stands_in_the_way_of_the_robots_width():
    ranges = np.full(181, np.inf, np.float32)
    footprint = np.array([(0.2, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.2, -0.3)])
    assert room_ahead(Scan(0, MOUNT, ranges), footprint) > 7.0
    ranges[90] = 0.6
    assert room_ahead(Scan(0, MOUNT, ranges), footprint) == pytest.approx(0.5, abs=0.01)
    # 34 degrees to the left and 0.45 m away: 0.25 m aside; and 0.31 m aside, where it passes.
    ranges[90 + 23] = 0.45
    assert room_ahead(Scan(0, MOUNT, ranges), footprint) == pytest.approx(0.1 + 0.45 * np.cos(0.602) - 0.2, abs=0.01)
    ranges[90 + 23] = 0.56
    assert room_ahead(Scan(0, MOUNT, ranges), footprint) == pytest.approx(0.5, abs=0.01)
