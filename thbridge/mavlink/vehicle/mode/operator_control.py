"""Operator control: the ground station that commands a robot, and the loss of its heartbeats."""

from sim.common.observations import TICKS_PER_SECOND
from thbridge.mavlink.values.conventions import BY_OTHERS, BY_PARTICIPANT
from thbridge.mavlink.values.vehicle_interface import (
    NO_READINGS,
    DenialKind,
    Denied,
    RobotReadings,
    Station,
    VehicleInterface,
)
from thbridge.mavlink.vehicle.parts import Announce, TextSeverity

_AWAY = TICKS_PER_SECOND
"""The station has lost command after this number of ticks with another commander. It is not 0, because the readings
show the game's reaction to a vehicle's request only some ticks later.
"""


class OperatorControl:
    """Commander of a robot, as its vehicle knows it.

    Args:
        robot: interface to the robot.
        lost_after: seconds without a heartbeat after which a station is lost.
        announce: sends a text to people at each change of the commander.

    Attributes:
        lost_after: see `Args`. It may be changed.
        station: the ground station that commands the robot, or None. It stays the same while a researcher drives the
            robot for some time.
    """

    def __init__(self, robot: VehicleInterface, lost_after: float, announce: Announce) -> None:
        self._robot = robot
        self._announce = announce
        self.lost_after = lost_after
        self.station: Station | None = None
        self._last_heartbeat = 0
        self._away = 0
        self._tick = 0
        self._readings = NO_READINGS

    @property
    def commander_id(self) -> int:
        """Commander as a number: a station's system id, `BY_PARTICIPANT`, or `BY_OTHERS`."""
        if self.station is not None and not self.is_overruled:
            return self.station.system
        return BY_PARTICIPANT if self._readings.commanded_by == self._readings.participant else BY_OTHERS

    @property
    def is_lost(self) -> bool:
        """True if the station that commands the robot has sent no heartbeat within the timeout."""
        return self.station is not None and self._tick - self._last_heartbeat > self._timeout

    @property
    def is_overruled(self) -> bool:
        """True while a person outside the game, such as a researcher, drives the robot instead of the station."""
        ours, readings = str(self.station), self._readings
        if self.station is None or readings.commander not in (None, ours):
            return False
        return readings.commanded_by not in (readings.participant, ours)

    @property
    def _timeout(self) -> int:
        return round(self.lost_after * TICKS_PER_SECOND)

    def objection(self, station: Station) -> Denied | None:
        """Return the reason why this station may not move the robot, or None."""
        if self.station is None:
            return Denied(f"Commanded by {self._readings.commanded_by}: arm the robot to take command.")
        reserved = self.reserved(station)
        if reserved is None and self.is_overruled:
            return Denied(f"Commanded by {self._readings.commanded_by} just now.", DenialKind.NOT_NOW)
        return reserved

    def reserved(self, station: Station) -> Denied | None:
        """Return a denial if another station commands the robot. It applies to settings that have an effect later."""
        if self.station in (None, station):
            return None
        return Denied(f"Commanded by {self.station}.")

    def take(self, station: Station, by_force: bool = False) -> Denied | None:
        """Let a station command the robot. `by_force` is required to replace another station that is not lost."""
        if station == self.station:
            return None
        if self.station is not None and not by_force and not self.is_lost:
            return Denied(f"Commanded by {self.station}: arm by force to take it over.")
        denied = self._robot.take(station)
        if denied is None:
            self.station, self._last_heartbeat, self._away = station, self._tick, 0
            self._announce(TextSeverity.NOTICE, f"Commanded by {station}.")
        return denied

    def release(self) -> None:
        """Let the participant command the robot again if a station commands it."""
        if self.station is not None:
            self.station = None
            self._robot.release()
            self._announce(TextSeverity.NOTICE, f"Commanded by the {self._readings.participant} again.")

    def heartbeat(self, station: Station) -> None:
        """Store the time of a heartbeat from any component of a station."""
        if self.station is not None and station.system == self.station.system:
            self._last_heartbeat = self._tick

    def follow(self, tick: int, readings: RobotReadings) -> bool:
        """Advance by one tick. Return True if the station has lost command to another commander."""
        self._tick, self._readings = tick, readings
        if self.station is None or readings.commander == str(self.station) or self.is_overruled:
            self._away = 0
            return False
        self._away += 1
        if self._away < _AWAY:
            return False
        self.station = None
        self._announce(TextSeverity.WARNING, f"Commanded by {readings.commanded_by} now.")
        return True
