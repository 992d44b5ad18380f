"""Options of vehicles, set by the study file."""

from dataclasses import dataclass
from enum import StrEnum

SHORTEST_TIMEOUT, LONGEST_TIMEOUT = 1.0, 600.0
"""Bounds of the seconds without a heartbeat after which a ground station counts as lost."""


class AutopilotIdentity(StrEnum):
    """Autopilot that a vehicle presents itself as; ground stations offer more functions to those that they know."""

    GENERIC = "generic"
    ARDUPILOT = "ardupilot"


class Failsafe(StrEnum):
    """Action of a robot when the ground station that commands it is lost."""

    STOP = "stop"
    HOME = "home"
    CONTINUE = "continue"


class VisitedRooms(StrEnum):
    """Action of a mission whose next item leads into a room that was visited already."""

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
        identity: autopilot that they present themselves as.
        origin: position of the map's origin on earth.
        lost_after: seconds without a heartbeat after which a ground station counts as lost.
        failsafe: action in that case.
        position_rate: default rate of position, attitude and speed messages, Hz.
        visited_rooms: action of a mission at a room that was visited already.
    """

    identity: AutopilotIdentity
    origin: GeoOrigin
    lost_after: float
    failsafe: Failsafe
    position_rate: float
    visited_rooms: VisitedRooms = VisitedRooms.HALT
