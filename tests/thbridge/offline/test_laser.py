import dataclasses
import math

import numpy as np
import pytest

from sim.common.geometry import Pose2
from thbridge.offline.laser import FAR, Laser, usable
from thbridge.ros.frames import PlanarMount
from thbridge.ros.messages.unpack import LaserScan

SEAT = PlanarMount(Pose2(0.1, 0.2, 0.3), upside_down=False, tilt=0.0)


def read(*ranges: float, angle_min: float = -1.0, increment: float = 0.5, **others: float) -> LaserScan:
    values = {"range_min": 0.1, "range_max": 10.0, "angle_max": angle_min + increment * (len(ranges) - 1)} | others
    return LaserScan(0, "laser", angle_min, values["angle_max"], increment, values["range_min"], values["range_max"],
                     np.array(ranges, dtype=np.float32))  # fmt: skip


FIRST = read(1, 2, 3, 4, 5)


def test_what_is_no_range_saw_nothing() -> None:
    seen = Laser.of(FIRST, SEAT).scan(3, read(0.0, math.nan, math.inf, 10.0, -math.inf)).ranges
    assert seen.tolist() == pytest.approx([math.inf, math.nan, math.inf, math.inf, math.inf], nan_ok=True)
    assert seen.dtype == np.float32


def test_beams_of_a_laser_upside_down_turn_clockwise() -> None:
    mount = Laser.of(FIRST, dataclasses.replace(SEAT, upside_down=True)).mount
    assert (mount.angle_min, mount.angle_increment, mount.laser_in_base) == (1.0, -0.5, SEAT.laser_in_base)


@pytest.mark.parametrize(
    ("later", "seen"),
    [
        (read(1, 2, 3, 4, angle_min=-1.0), [1, 2, 3, 4, math.nan]),
        (read(9, 1, 2, 3, 4, 5, 9, angle_min=-1.5), [1, 2, 3, 4, 5]),
        (read(*range(1, 10), increment=0.25), [1, 3, 5, 7, 9]),
        (read(7, 8, angle_min=0.6), [math.nan, math.nan, math.nan, 7, 8]),
        (read(5, 4, 3, 2, 1, angle_min=1.0, increment=-0.5), [1, 2, 3, 4, 5]),
    ],
)
def test_other_beams_are_read_at_the_nearest(later: LaserScan, seen: list[float]) -> None:
    assert Laser.of(FIRST, SEAT).scan(0, later).ranges.tolist() == pytest.approx(seen, nan_ok=True)


@pytest.mark.parametrize("range_max", [0.0, math.nan, math.inf, -1.0])
def test_a_driver_that_does_not_say_how_far_it_sees(range_max: float) -> None:
    assert Laser.of(read(1, 2, range_max=range_max), SEAT).mount.range_max == FAR
    assert Laser.of(read(1, 70, math.inf, range_max=range_max), SEAT).mount.range_max == 70.0


def test_the_increment_may_be_left_to_the_outermost_beams() -> None:
    scan = read(1, 2, 3, increment=0.0, angle_max=1.0)
    assert usable(scan)
    assert Laser.of(scan, SEAT).mount.angle_increment == 1.0
    assert not usable(read(1, 2, 3, increment=0.0))
    assert not usable(read(1))
    assert not usable(read(1, 2, angle_min=math.nan))
