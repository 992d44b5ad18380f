"""The camera leads from map to screen and back, and zooms about a point."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ui.windows.map.camera import MAX_SCALE, Camera

metres = st.floats(-50.0, 50.0)
cameras = st.builds(Camera, metres, metres, st.floats(5.0, 300.0), st.floats(100.0, 2000.0), st.floats(100.0, 2000.0))


@given(cameras, metres, metres)
def test_to_the_screen_and_back(camera: Camera, x: float, y: float) -> None:
    assert camera.point(*camera.pixel(x, y)) == pytest.approx((x, y), abs=1e-6)
    pixels = camera.to_screen(np.array([[x, y]]))
    assert pixels[0] == pytest.approx(camera.pixel(x, y), abs=1e-6)
    assert camera.to_map(pixels)[0] == pytest.approx((x, y), abs=1e-6)


@given(cameras, st.floats(0.1, 10.0), st.floats(0.0, 2000.0), st.floats(0.0, 2000.0))
def test_the_point_zoomed_about_stays(camera: Camera, factor: float, px: float, py: float) -> None:
    zoomed = camera.zoomed(factor, px, py)
    assert zoomed.point(px, py) == pytest.approx(camera.point(px, py), abs=1e-6)
    assert zoomed.scale <= MAX_SCALE


@given(cameras, st.sampled_from([1.0, 1.25, 1.5, 2.0]))
def test_snapping_moves_less_than_a_device_pixel(camera: Camera, ratio: float) -> None:
    px, py = camera.snapped(ratio).pixel(0.0, 0.0)
    assert px * ratio == pytest.approx(round(px * ratio), abs=1e-4)
    assert py * ratio == pytest.approx(round(py * ratio), abs=1e-4)
    assert math.dist((px, py), camera.pixel(0.0, 0.0)) < 1.0 / ratio


@given(cameras, st.sampled_from([1.0, 1.25, 1.5, 2.0]))
def test_snapping_twice_changes_nothing_more(camera: Camera, ratio: float) -> None:
    snapped = camera.snapped(ratio)
    assert snapped.snapped(ratio) == snapped


def test_north_is_up_and_a_house_fits() -> None:
    camera = Camera.fitted((-5.0, -2.0, 5.0, 2.0), 1000.0, 800.0, 50.0)
    assert camera.pixel(-5.0, 0.0)[0] == pytest.approx(50.0)
    assert camera.pixel(5.0, 0.0)[0] == pytest.approx(950.0)
    assert camera.pixel(0.0, 2.0)[1] < camera.pixel(0.0, -2.0)[1]
