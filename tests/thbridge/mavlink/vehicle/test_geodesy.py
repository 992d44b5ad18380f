"""The map on earth: meters as degrees and back."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from thbridge.mavlink.values.options import GeoOrigin
from thbridge.mavlink.vehicle.geodesy import GeoPoint, MapProjection

METRES = st.floats(-500.0, 500.0)


@given(st.floats(-85.0, 85.0), st.floats(-180.0, 180.0), METRES, METRES)
def test_a_point_comes_back_within_two_centimetres(latitude, longitude, x, y):
    earth = MapProjection(GeoOrigin(latitude, longitude, 0.0))
    again = earth.map_point(earth.geo_point(x, y))
    assert math.dist((x, y), again) < 0.02


@given(METRES, METRES)
def test_the_date_line_is_no_edge(x, y):
    place = MapProjection(GeoOrigin(10.0, 180.0, 0.0)).geo_point(x, y)
    assert -1_800_000_000 <= place.longitude < 1_800_000_000


@pytest.mark.parametrize(
    ("latitude", "metres_north", "metres_east"),
    # Lengths of a degree as tables of WGS84 have them.
    [(0.0, 110_574.3, 111_319.5), (45.0, 111_131.8, 78_846.8), (60.0, 111_412.2, 55_800.0)],
)
def test_a_degree_is_as_long_as_on_wgs84(latitude, metres_north, metres_east):
    earth = MapProjection(GeoOrigin(latitude, 7.0, 0.0))
    place = earth.geo_point(metres_east / 1000.0, metres_north / 1000.0)
    assert place.latitude - latitude * 1e7 == pytest.approx(10_000, abs=2)
    assert place.longitude - 7.0 * 1e7 == pytest.approx(10_000, abs=2)


def test_the_origin_is_the_map_s_origin():
    assert MapProjection(GeoOrigin(52.4, 9.7, 55.0)).geo_point(0.0, 0.0) == GeoPoint(524_000_000, 97_000_000)


@pytest.mark.parametrize("far", [1e9, 1e30, -1e30])
def test_what_lies_beyond_a_pole_lies_at_the_pole_and_can_be_told(far):
    place = MapProjection(GeoOrigin(51.5, -0.1, 20.0)).geo_point(far, far)
    assert place.latitude == math.copysign(900_000_000, far)
    assert -1_800_000_000 <= place.longitude < 1_800_000_000
