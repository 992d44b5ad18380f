"""Options of vehicles, set by the study file."""

from dataclasses import dataclass
from enum import StrEnum

SHORTEST_TIMEOUT, LONGEST_TIMEOUT = 1.0, 600.0
"""Bounds of the heartbeat timeout, in seconds: without a heartbeat for this time, a ground station is lost."""


class AutopilotIdentity(StrEnum):
    """Autopilot that a vehicle claims to have; ground stations offer more functions to autopilots that they know."""

    GENERIC = "generic"
    ARDUPILOT = "ardupilot"


class Failsafe(StrEnum):
    """Action of a robot when its commanding ground station is lost."""

    STOP = "stop"
    HOME = "home"
    CONTINUE = "continue"


class VisitedRooms(StrEnum):
    """Action of a mission when its next item leads into an already visited room."""

    HALT = "halt"
    SKIP = "skip"


@dataclass(frozen=True, slots=True)
class GeoOrigin:
    """Position of the map's origin, WGS84: degrees north and east, meters above sea level; north is map y."""

    latitude: float
    longitude: float
    altitude: float


@dataclass(frozen=True, slots=True)
class VehicleOptions:
    """Options of all vehicles of a study.

    Attributes:
        identity: autopilot that the vehicles claim to have.
        origin: position of the map's origin on earth.
        lost_after: seconds without a heartbeat after which a ground station is lost.
        failsafe: action in that case.
        position_rate: default rate of position, attitude and speed messages, Hz.
        visited_rooms: action of a mission at an already visited room.
    """

    identity: AutopilotIdentity
    origin: GeoOrigin
    lost_after: float
    failsafe: Failsafe
    position_rate: float
    visited_rooms: VisitedRooms = VisitedRooms.HALT
