"""Options of vehicles. The study file sets them."""

from dataclasses import dataclass
from enum import StrEnum

SHORTEST_TIMEOUT, LONGEST_TIMEOUT = 1.0, 600.0
"""Bounds of the heartbeat timeout, seconds. A ground station without a heartbeat for this time is lost."""


class AutopilotIdentity(StrEnum):
    """Autopilot that a vehicle claims to have. Ground stations offer more functions for autopilots that they know."""

    GENERIC = "generic"
    ARDUPILOT = "ardupilot"


class Failsafe(StrEnum):
    """Action of a robot after the loss of the ground station that commands it."""

    STOP = "stop"
    HOME = "home"
    CONTINUE = "continue"


class VisitedRooms(StrEnum):
    """Action of a mission if its next item leads into an already visited room."""

    HALT = "halt"
    SKIP = "skip"


@dataclass(frozen=True, slots=True)
class GeoOrigin:
    """Position of the map's origin in WGS84: degrees north and east, meters above sea level. Map y is north."""

    latitude: float
    longitude: float
    altitude: float


@dataclass(frozen=True, slots=True)
class VehicleOptions:
    """Options of all vehicles of a study.

    Attributes:
        identity: autopilot that the vehicles claim to have.
        origin: position of the map's origin on earth.
        lost_after: a ground station is lost after this number of seconds without a heartbeat.
        failsafe: action of a robot whose ground station is lost.
        position_rate: default rate of position, attitude and speed messages, Hz.
        visited_rooms: action of a mission at an already visited room.
    """

    identity: AutopilotIdentity
    origin: GeoOrigin
    lost_after: float
    failsafe: Failsafe
    position_rate: float
    visited_rooms: VisitedRooms = VisitedRooms.HALT
