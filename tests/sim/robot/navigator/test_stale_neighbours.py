import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import STANDSTILL, TICK, LaserMount, Neighbour, Scan, Twist
from sim.robot.navigator.stale_neighbours import STALE_TIMEOUT, StaleNeighbours

BODY = np.array([(0.25, 0.25), (-0.25, 0.25), (-0.25, -0.25), (0.25, -0.25)])
MOUNT = LaserMount(Pose2(0.1, 0.0, 0.0), -2.0, 0.1, 41, 0.05, 8.0)


def under_way(robot: int, x: float) -> Neighbour:
    way = np.array([[x, 0.0], [x + 1.0, 0.0]])
    return Neighbour(robot, Pose2(x, 0.0, 0.0), Twist(0.5, 0.0), BODY, way, np.array([0.0, 2.0]))


def scan(reach: float) -> Scan:
    return Scan(0, MOUNT, np.full(41, reach, np.float32))


def fallen_silent() -> StaleNeighbours:
    silence = StaleNeighbours()
    silence.update(1, [under_way(1, 2.0), under_way(2, 5.0)])
    silence.update(2, [under_way(2, 5.1)])
    return silence


def test_who_speaks_is_not_silent() -> None:
    silence = StaleNeighbours()
    silence.update(1, [under_way(1, 2.0)])
    silence.update(2, [under_way(1, 2.0)])
    assert silence.remembered(2) == []
    assert silence.highest_robot == 1


def test_who_falls_silent_stands_where_it_was_heard_last() -> None:
    silence = fallen_silent()
    (word,) = silence.remembered(2)
    assert (word.robot, word.base_in_map, word.twist) == (1, Pose2(2.0, 0.0, 0.0), STANDSTILL)
    assert len(word.path) == len(word.times) == 0
    (body,) = silence.bodies()
    assert body.twist == Twist(0.5, 0.0), "it may have rolled on that far"


def test_plans_forget_it_in_time_and_brakes_do_not() -> None:
    silence = fallen_silent()
    late = 2 + round(STALE_TIMEOUT / TICK) + 1
    silence.update(late, [under_way(2, 5.1)])
    assert silence.remembered(late) == []
    assert len(silence.bodies()) == 1


def test_who_speaks_again_is_taken_by_its_new_word() -> None:
    silence = fallen_silent()
    silence.update(3, [under_way(1, 7.0), under_way(2, 5.1)])
    assert silence.bodies() == []


def test_a_laser_that_looks_through_its_place_shows_that_it_has_gone() -> None:
    silence = fallen_silent()
    silence.forget_seen_through(Pose2(0.1, 0.0, 0.0), scan(1.6))
    assert len(silence.bodies()) == 1
    silence.forget_seen_through(Pose2(0.1, 0.0, 3.14), scan(4.0))
    assert len(silence.bodies()) == 1, "it looks the other way"
    silence.forget_seen_through(Pose2(0.1, 0.0, 0.0), scan(4.0))
    assert silence.bodies() == []
