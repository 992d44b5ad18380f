"""A script for one robot as researchers write them with DroneKit, run by DroneKit's own Python.

Its standard input is one JSON object: `url` to listen at, where one robot alone is heard, whether it says that it is
`ardupilot`'s, the name of a `parameter` to set, and places as latitude and longitude: two to `drive` to, a `mission`,
and one in a `room`, or none. Where there is a room, it is driven by hand, sent home, and connected to again, too. The
last line of its output is another object, what it saw.
"""

import json
import logging
import math
import os
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from typing import Any

from dronekit import Command, LocationGlobal, LocationGlobalRelative, Vehicle, connect
from dronekit.mission import CommandInt
from pymavlink import mavutil

mav = mavutil.mavlink

PATIENCE = 60.0
STILL = 0.02
"""Meters per second."""

Told = dict[str, Any]
Place = Sequence[float]


def metres(one: Any, other: Place) -> float:
    """How far a location is from a place."""
    north = math.radians(one.lat - other[0]) * 6_371_000.0
    east = math.radians(one.lon - other[1]) * 6_371_000.0 * math.cos(math.radians(other[0]))
    return math.hypot(north, east)


class Notes(logging.Handler):
    """What the autopilot says to people, as DroneKit logs it."""

    def __init__(self) -> None:
        super().__init__()
        self.said: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.said.append(record.getMessage())


class Rover:
    """One robot, by what DroneKit offers for it."""

    def __init__(self, orders: Told) -> None:
        # Of another autopilot DroneKit never tells a mode, nor where home is as long as there is no mission.
        self.ardupilot = orders["ardupilot"]
        ready = True if self.ardupilot else ["parameters", "gps_0", "armed", "attitude"]
        self.vehicle = connect(orders["url"], wait_ready=ready, timeout=PATIENCE, heartbeat_timeout=PATIENCE)
        self.notes = Notes()
        autopilot = logging.getLogger("autopilot")
        autopilot.setLevel(logging.DEBUG)
        autopilot.addHandler(self.notes)

    def waits(self, what: str, until: Callable[[], bool]) -> None:
        self.vehicle.wait_for(until, timeout=PATIENCE, interval=0.02, errmsg=f"{what}; {self.notes.said}")

    def hears(self, text: str) -> None:
        self.waits(f"to be told {text!r}", lambda: text in self.notes.said)
        self.notes.said.clear()

    def reaches(self, place: Place) -> None:
        def there() -> bool:
            away = metres(self.vehicle.location.global_frame, place)
            return away < 0.4 and self.vehicle.groundspeed < STILL

        self.waits(f"to be at {place}", there)

    def downloads(self) -> list[Any]:
        commands = self.vehicle.commands
        commands.download()
        commands.wait_ready(timeout=PATIENCE)
        return list(commands)

    # -- what it is told to do ----------------------------------------------------------------------------------------

    def is_well(self) -> Told:
        vehicle = self.vehicle
        vehicle.wait_for_armable(timeout=PATIENCE)
        if self.ardupilot:
            self.downloads()
        self.waits("its version", lambda: vehicle.version.raw_version is not None)
        self.waits("its battery and heading", lambda: vehicle.battery is not None and vehicle.heading is not None)
        home, at = vehicle.home_location, vehicle.location.global_frame
        return {
            "version": str(vehicle.version),
            "capabilities": vars(vehicle.capabilities),
            "status": vehicle.system_status.state if vehicle.system_status else None,
            "mode": vehicle.mode.name,
            "armed": vehicle.armed,
            "ekf": vehicle.ekf_ok,
            "fix": vehicle.gps_0.fix_type,
            "battery": vehicle.battery.level,
            "heading": vehicle.heading,
            "yaw": vehicle.attitude.yaw,
            "home": (home.lat, home.lon, home.alt) if home else None,
            "at": (at.lat, at.lon, at.alt),
        }

    def changes_modes(self) -> list[str]:
        for mode in ("GUIDED", "HOLD", "RTL", "MANUAL", "GUIDED"):
            self.vehicle.wait_for_mode(mode, timeout=PATIENCE)
        return [str(self.vehicle.mode.name), self.vehicle.system_status.state]

    def drives(self, there: Place, back: Place) -> Told:
        vehicle = self.vehicle
        seen: Told = {"local": [], "global": []}

        @vehicle.on_message("LOCAL_POSITION_NED")
        def local(robot: Vehicle, _: str, message: Any) -> None:
            frame = robot.location.local_frame
            seen["local"].append((message.time_boot_ms, frame.east, frame.north))

        @vehicle.on_message("GLOBAL_POSITION_INT")
        def globe(robot: Vehicle, _: str, message: Any) -> None:
            frame = robot.location.global_frame
            seen["global"].append((message.time_boot_ms, frame.lat, frame.lon))

        vehicle.simple_goto(LocationGlobalRelative(*there, 0.0), groundspeed=0.6)
        self.waits("to be on its way", lambda: vehicle.groundspeed > 0.3)
        self.reaches(there)
        seen["slow"] = len(seen["local"])
        home = vehicle.home_location
        on_earth = LocationGlobal(*back, home.alt) if home else LocationGlobalRelative(*back, 0.0)
        vehicle.simple_goto(on_earth, groundspeed=1.0)
        self.hears("Arrived.")
        self.reaches(back)
        return seen

    def carries_out(self, mission: Sequence[Place]) -> Told:
        vehicle, commands = self.vehicle, self.vehicle.commands
        self.downloads()
        commands.clear()
        # As in DroneKit's guide: neither current nor to be continued.
        frame = mav.MAV_FRAME_GLOBAL_RELATIVE_ALT
        items = [Command(0, 0, 0, frame, mav.MAV_CMD_NAV_WAYPOINT, 0, 0, 0, 0, 0, 0, *place, 0) for place in mission]
        commands.add(items[0])
        for item in items[1:]:
            commands.add(CommandInt.from_command(item))
        commands.upload(timeout=PATIENCE)
        back = [(item.x, item.y) for item in self.downloads()]
        commands.next = 0
        vehicle.wait_for_mode("AUTO", timeout=PATIENCE)
        self.hears("Mission complete.")
        self.waits("to hold", lambda: vehicle.mode == "HOLD")
        at = vehicle.location.global_frame
        done = commands.next
        commands.clear()
        commands.upload(timeout=PATIENCE)
        return {"downloaded": back, "ended": (at.lat, at.lon), "at item": done, "left": len(self.downloads())}

    def sets_parameters(self, name: str) -> Told:
        parameters = self.vehicle.parameters
        heard: list[tuple[str, float]] = []
        parameters.add_attribute_listener(name, lambda _, what, value: heard.append((what, value)))
        before = parameters[name]
        taken = parameters.set(name, 2 * before)
        refused = parameters.set(name, -7.0, retries=0)
        self.waits("why it was refused", lambda: any("at least 0" in text for text in self.notes.said))
        unknown = parameters.set("DOES_NOT_EXIST", 1.0, retries=0)
        return {
            "count": len(parameters), "before": before, "taken": taken, "refused": refused, "unknown": unknown,
            "heard": heard, "after": parameters[name],
        }  # fmt: skip

    def is_driven_by_hand(self) -> Told:
        """By a radio's channels, and by velocities that are said once a second."""
        vehicle = self.vehicle
        vehicle.wait_for_mode("MANUAL", timeout=PATIENCE)
        vehicle.channels.overrides = {"1": 1500, "3": 1700}
        self.waits("to move", lambda: vehicle.groundspeed > 0.1)
        vehicle.channels.overrides = {}
        self.waits("to stand", lambda: vehicle.groundspeed < STILL)
        vehicle.wait_for_mode("GUIDED", timeout=PATIENCE)
        velocity = vehicle.message_factory.set_position_target_local_ned_encode(
            0, 0, 0, mav.MAV_FRAME_BODY_OFFSET_NED, 0b0000111111000111, 0, 0, 0, 0.3, 0, 0, 0, 0, 0, 0, 0
        )
        vehicle.send_mavlink(velocity)
        self.waits("to move", lambda: vehicle.groundspeed > 0.2)
        began = time.monotonic()
        self.waits("to stand", lambda: vehicle.groundspeed < STILL)
        return {"moved for": time.monotonic() - began}

    def is_told_no(self) -> list[str]:
        """What a robot of a game does not do, or nobody without command may ask for."""
        vehicle, said = self.vehicle, self.notes.said
        said.clear()
        vehicle.reboot()
        self.waits("a refusal", lambda: len(said) == 1)
        vehicle.wait_for_mode("HOLD", timeout=PATIENCE)
        vehicle.mode = "AUTO"
        self.waits("another", lambda: len(said) == 2)
        return list(said)

    def returns(self, home: Place) -> Told:
        """Home is set, read back, and returned to."""
        vehicle = self.vehicle
        vehicle.home_location = LocationGlobal(*home, vehicle.location.global_frame.alt)
        vehicle.wait_for_mode("RTL", timeout=PATIENCE)
        self.hears("Arrived.")
        self.downloads()
        at = vehicle.location.global_frame
        return {"home": (vehicle.home_location.lat, vehicle.home_location.lon), "at": (at.lat, at.lon)}

    def goes_into(self, room: Place) -> Told:
        before = self.vehicle.battery.level
        self.vehicle.simple_goto(LocationGlobalRelative(*room, 0.0))
        self.hears("Arrived.")
        self.waits("less energy", lambda: self.vehicle.battery.level < before)
        at = self.vehicle.location.local_frame
        return {"at": (at.east, at.north)}


def plays(orders: Told) -> Told:
    rover = Rover(orders)
    told: Told = {"well": rover.is_well()}
    rover.vehicle.arm(timeout=PATIENCE)
    if orders["ardupilot"]:
        told["mode"], told["status"] = rover.changes_modes()
    told["drive"] = rover.drives(*orders["drive"])
    if orders["ardupilot"]:
        told["mission"] = rover.carries_out(orders["mission"])
        told["no"] = rover.is_told_no()
    told["parameters"] = rover.sets_parameters(orders["parameter"])
    if orders["room"]:
        told["hand"] = rover.is_driven_by_hand()
        told["home"] = rover.returns(orders["mission"][0])
        told["room"] = rover.goes_into(orders["room"])
    rover.vehicle.disarm(timeout=PATIENCE)
    rover.vehicle.close()
    if orders["room"]:
        again = Rover(orders)
        told["again"] = again.vehicle.armed
        again.vehicle.close()
    return told


if __name__ == "__main__":
    try:
        print(json.dumps(plays(json.load(sys.stdin))), flush=True)
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)  # its threads may wait for ever
