"""Map projection: a plane tangent to the WGS84 ellipsoid at the map's origin, with its y axis north.

Source: WGS 84 (NGA.STND.0036), semi-axes; the radii of curvature of an ellipsoid.
Differences from the source: the plane is flat, so points 1 km from the origin have an error of some centimeters. Maps
are smaller than 1 km.
"""

import math
from dataclasses import dataclass
from typing import TypeVar

from sim.numerics import elementary
from thbridge.mavlink.values.options import GeoOrigin

_SEMI_MAJOR = 6_378_137.0
_FLATTENING = 1.0 / 298.257223563
_ECCENTRICITY_SQUARED = _FLATTENING * (2.0 - _FLATTENING)

Number = TypeVar("Number", int, float)

PER_DEGREE = 10_000_000
"""MAVLink's units per degree. A unit of latitude is 1.1 cm."""

_WHOLE_TURN = 360 * PER_DEGREE
_POLE = 90 * PER_DEGREE


@dataclass(frozen=True, slots=True)
class GeoPoint:
    """Point on earth: latitude north of the equator and longitude east of Greenwich, in units of 1e-7 degrees."""

    latitude: int
    longitude: int

    @property
    def is_on_earth(self) -> bool:
        """True if latitude and longitude are in range."""
        return abs(self.latitude) <= _POLE and abs(self.longitude) <= _WHOLE_TURN // 2

    @property
    def is_unset(self) -> bool:
        """True for (0, 0). Ground stations send it instead of a place, with the meaning "here"."""
        return self.latitude == 0 and self.longitude == 0


class MapProjection:
    """Conversion between meters of the map and degrees.

    Args:
        origin: position of the map's origin. It must not be a pole.
    """

    def __init__(self, origin: GeoOrigin) -> None:
        self.altitude = origin.altitude
        phi = math.radians(origin.latitude)
        sine = elementary.sin(phi)
        shrink = 1.0 - _ECCENTRICITY_SQUARED * (sine * sine)
        root = math.sqrt(shrink)
        meridian = _SEMI_MAJOR * (1.0 - _ECCENTRICITY_SQUARED) / (shrink * root)
        parallel = _SEMI_MAJOR / root * elementary.cos(phi)
        self._latitude = origin.latitude * PER_DEGREE
        self._longitude = origin.longitude * PER_DEGREE
        self._north = math.degrees(1.0 / meridian) * PER_DEGREE
        self._east = math.degrees(1.0 / parallel) * PER_DEGREE

    def geo_point(self, x: float, y: float) -> GeoPoint:
        """Convert a point of the map, meters east and north, to a point on earth. Latitudes end at the poles."""
        latitude = round(self._latitude + y * self._north)
        longitude = round(self._longitude + x * self._east)
        return GeoPoint(min(max(latitude, -_POLE), _POLE), _half_turn(longitude))

    def map_point(self, place: GeoPoint) -> tuple[float, float]:
        """Convert a point on earth to a point of the map, meters east and north."""
        east = _half_turn(place.longitude - self._longitude)
        return east / self._east, (place.latitude - self._latitude) / self._north


def _half_turn(longitude: Number) -> Number:
    """Return the same longitude in the range from -180 to 180 degrees."""
    return (longitude + _WHOLE_TURN // 2) % _WHOLE_TURN - _WHOLE_TURN // 2
