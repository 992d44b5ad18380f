"""Encoders of sensor messages: laser scan and battery state."""

import math
from struct import Struct

from sim.common.observations import Battery, Scan
from thbridge.ros.messages.pack.fields import UINT32, header, string

_LASER = Struct("<7f")
_BATTERY = Struct("<7f4B")

_POWER_SUPPLY_UNKNOWN = 0
_POWER_SUPPLY_STATUS_DISCHARGING = 2


def laser_scan(scan: Scan, frame: str, period: float) -> bytes:
    """Encode sensor_msgs/LaserScan without intensities.

    Args:
        scan: a scan. All its beams are measured at the same time.
        frame: the laser's frame.
        period: seconds between two scans.
    """
    mount = scan.mount
    angle_max = mount.angle_min + mount.angle_increment * (mount.beams - 1)
    return b"".join(
        (
            header(scan.tick, frame),
            _LASER.pack(
                mount.angle_min, angle_max, mount.angle_increment, 0.0, period, mount.range_min, mount.range_max
            ),
            UINT32.pack(len(scan.ranges)),
            scan.ranges.astype("<f4", copy=False).tobytes(),
            UINT32.pack(0),
        )
    )


def battery_state(battery: Battery, robot: str) -> bytes:
    """Encode sensor_msgs/BatteryState. Charge and capacity are the energy of the game. Other values are NaN.

    Args:
        battery: battery. Its charge may be negative, and its capacity is positive.
        robot: name of the robot, which is written as serial number.
    """
    share = battery.charge / battery.capacity
    measured = (math.nan, math.nan, math.nan, battery.charge, battery.capacity, battery.capacity, share)
    present = 1
    cells = UINT32.pack(0)
    return b"".join(
        (
            header(battery.tick),
            _BATTERY.pack(
                *measured, _POWER_SUPPLY_STATUS_DISCHARGING, _POWER_SUPPLY_UNKNOWN, _POWER_SUPPLY_UNKNOWN, present
            ),
            cells,
            cells,
            string(""),
            string(robot),
        )
    )
