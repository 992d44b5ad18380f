"""What a study decides about vehicles."""

from dataclasses import dataclass
from enum import StrEnum

SHORTEST_PATIENCE, LONGEST_PATIENCE = 1.0, 600.0
"""Seconds without a heartbeat after which a ground station may count as lost."""


class AutopilotIdentity(StrEnum):
    """Whose autopilot a vehicle says it has; ground stations offer more to those that they know."""

    GENERIC = "generic"
    ARDUPILOT = "ardupilot"


class Failsafe(StrEnum):
    """What a robot does when the ground station that commands it is not heard any more."""

    STOP = "stop"
    HOME = "home"
    CONTINUE = "continue"


@dataclass(frozen=True, slots=True)
class GeoOrigin:
    """Where on earth the map's origin lies, WGS84: degrees north and east, metres above sea level; north is map y."""

    latitude: float
    longitude: float
    altitude: float


@dataclass(frozen=True, slots=True)
class VehicleOptions:
    """What a study decides about vehicles.

    Attributes:
        identity: whose autopilot they say they have.
        origin: where the map lies on earth.
        lost_after: seconds without a heartbeat after which a ground station counts as lost.
        failsafe: what is done then.
        position_rate: of position, attitude and speed, Hz, as long as nobody asks for another rate.
    """

    identity: AutopilotIdentity
    origin: GeoOrigin
    lost_after: float
    failsafe: Failsafe
    position_rate: float
