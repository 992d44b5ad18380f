"""Home position of a robot. It is the start pose until a ground station sets another position.

Source: MAVLink's `common.xml`, MAV_CMD_DO_SET_HOME, SET_HOME_POSITION and HOME_POSITION.
Differences from the source: if the robot cannot stand at a new home position, the position is refused at once, not
when the robot returns to it.
"""

import math
from collections.abc import Iterator

from thbridge.mavlink.values.vehicle_interface import (
    NO_READINGS,
    DenialKind,
    Denied,
    RobotReadings,
    Target,
    VehicleInterface,
)
from thbridge.mavlink.vehicle.boot_time import microseconds
from thbridge.mavlink.vehicle.geodesy import GeoPoint, MapProjection
from thbridge.mavlink.vehicle.parts import Microservice
from thbridge.mavlink.wire.coordinates import quaternion
from thbridge.mavlink.wire.dialect import Message, mav
from thbridge.mavlink.wire.outgoing import OutgoingMessage

_NO_HEADING = (math.nan,) * 4


class HomePosition(Microservice):
    """Home position of one vehicle. Other microservices handle the messages that set it.

    Args:
        robot: interface to the robot.
        earth: map projection.

    Attributes:
        target: home position in the map.
    """

    def __init__(self, robot: VehicleInterface, earth: MapProjection) -> None:
        self._robot = robot
        self._earth = earth
        self._readings = NO_READINGS
        start = robot.start()
        self.target = Target(start.x, start.y, start.theta)
        self._is_news = False

    @property
    def place(self) -> GeoPoint:
        """Home position on earth."""
        return self._earth.geo_point(self.target.x, self.target.y)

    def set_here(self) -> Denied | None:
        """Set the home position to the robot's current pose."""
        if self._readings.lost:
            return Denied("The robot does not know where it is.", DenialKind.NOT_NOW)
        here = self._readings.base_in_map
        return self.set_to(Target(here.x, here.y, here.theta))

    def set_to(self, target: Target) -> Denied | None:
        """Set the home position to another place. A robot that is returning continues to the earlier home position."""
        denied = self._robot.misplaced(target.x, target.y)
        if denied is None:
            self.target, self._is_news = target, True
        return denied

    def position(self, tick: int) -> Message:
        """Return the message HOME_POSITION for a tick."""
        home, place = self.target, self.place
        where = (place.latitude, place.longitude, round(self._earth.altitude * 1000.0), home.y, home.x, 0.0)
        heading = _NO_HEADING if home.heading is None else quaternion(home.heading)
        approach, now = (0.0, 0.0, 0.0), microseconds(tick)
        return mav.MAVLink_home_position_message(*where, list(heading), *approach, now)

    def step(self, tick: int, readings: RobotReadings) -> Iterator[OutgoingMessage]:
        """Return the message HOME_POSITION for all links if the home position has changed."""
        self._readings = readings
        if self._is_news:
            self._is_news = False
            yield OutgoingMessage(self.position(tick))
