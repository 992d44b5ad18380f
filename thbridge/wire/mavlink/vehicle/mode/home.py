"""Where a robot returns to: where it started, until a ground station says otherwise.

Source: MAVLink's `common.xml`, MAV_CMD_DO_SET_HOME, SET_HOME_POSITION and HOME_POSITION.
Differs: a home where the robot could not stand is refused at once, and not when the robot returns to it.
"""

import math
from collections.abc import Iterator

from thbridge.wire.mavlink.coordinates import quaternion
from thbridge.wire.mavlink.dialect import Message, mav
from thbridge.wire.mavlink.outgoing import LinkId, OutgoingMessage
from thbridge.wire.mavlink.vehicle.boot_time import microseconds
from thbridge.wire.mavlink.vehicle.geodesy import GeoPoint, MapProjection
from thbridge.wire.mavlink.vehicle_interface import (
    NOTHING_KNOWN,
    DenialKind,
    Denied,
    RobotReadings,
    Station,
    Target,
    VehicleInterface,
)

_NO_HEADING = (math.nan,) * 4


class HomePosition:
    """The home of one vehicle; a `Part`.

    Args:
        helm: the robot.
        earth: where its map lies.
    """

    def __init__(self, helm: VehicleInterface, earth: MapProjection) -> None:
        self._helm = helm
        self._earth = earth
        self._readings = NOTHING_KNOWN
        start = helm.start()
        self._target = Target(start.x, start.y, start.theta)
        self._is_news = False

    @property
    def target(self) -> Target:
        """Where it is."""
        return self._target

    @property
    def place(self) -> GeoPoint:
        """Where on earth it is."""
        return self._earth.place(self._target.x, self._target.y)

    def set_here(self) -> Denied | None:
        """Make it where the robot stands, looking as the robot does."""
        if self._readings.lost:
            return Denied("The robot does not know where it is.", DenialKind.NOT_NOW)
        here = self._readings.base_in_map
        return self.set_to(Target(here.x, here.y, here.theta))

    def set_to(self, target: Target) -> Denied | None:
        """Make it another place. A robot that is on its way home goes on to where home was when it set out."""
        denied = self._helm.misplaced(target.x, target.y)
        if denied is None:
            self._target, self._is_news = target, True
        return denied

    def position(self, tick: int) -> Message:
        """HOME_POSITION in a tick."""
        home, place = self._target, self.place
        where = (place.latitude, place.longitude, round(self._earth.altitude * 1000.0), home.y, home.x, 0.0)
        heading = _NO_HEADING if home.heading is None else quaternion(home.heading)
        approach, now = (0.0, 0.0, 0.0), microseconds(tick)
        return mav.MAVLink_home_position_message(*where, list(heading), *approach, now)

    def hear(self, link: LinkId, sender: Station, message: Message) -> Iterator[OutgoingMessage]:
        """Nothing is heard: others say where it is to be."""
        return iter(())

    def step(self, tick: int, readings: RobotReadings) -> Iterator[OutgoingMessage]:
        """A tick has passed; everybody is told where home has been set to."""
        self._readings = readings
        if self._is_news:
            self._is_news = False
            yield OutgoingMessage(self.position(tick))

    def forget(self, link: LinkId) -> None:
        """Nothing is known of links."""
