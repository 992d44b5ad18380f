"""A script for drones as most are written: with pymavlink's `mavutil`."""

import math
import os
import time
from collections.abc import Callable
from typing import Any

os.environ["MAVLINK20"] = "1"
from pymavlink import mavutil

mav = mavutil.mavlink

PATIENCE = 120.0


class Script:
    """One connection of mavutil's, to one robot, with a heartbeat of its own."""

    def __init__(self, where: str, own: int) -> None:
        self.master: Any = mavutil.mavlink_connection(where, source_system=own, source_component=190, dialect="all")
        self._beaten = -math.inf

    def follows(self, system: int) -> None:
        self.master.target_system, self.master.target_component = system, 1

    def beat(self) -> None:
        if time.monotonic() - self._beaten > 0.5:
            self._beaten = time.monotonic()
            self.master.mav.heartbeat_send(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 0)

    def hears(self, kind: str, wanted: Callable[[Any], bool] = lambda _: True, seconds: float = PATIENCE) -> Any:
        """The next message of the robot that is as wanted."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.beat()
            told = self.master.recv_match(type=kind.split("|"), blocking=True, timeout=0.2)
            if told is not None and told.get_srcSystem() == self.master.target_system and wanted(told):
                return told
        raise TimeoutError(f"waited {seconds} s for {kind}")

    def result(self, command: int) -> int:
        return int(self.hears("COMMAND_ACK", lambda told: told.command == command).result)

    def commands(self, command: int, *params: float) -> int:
        seven = [*params, *[0.0] * (7 - len(params))]
        self.master.mav.command_long_send(self.master.target_system, 1, command, 0, *seven)
        return self.result(command)

    def is_in(self, mode: str) -> None:
        self.hears("HEARTBEAT", lambda told: mavutil.mode_string_v10(told) == mode)

    def arms(self) -> None:
        self.master.arducopter_arm()
        self.hears("HEARTBEAT", lambda told: bool(told.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED))

    def reaches(self, east: float, north: float) -> None:
        def there(told: Any) -> bool:
            return math.dist((told.y, told.x), (east, north)) < 0.35 and math.hypot(told.vx, told.vy) < 0.02

        self.hears("LOCAL_POSITION_NED", there)
