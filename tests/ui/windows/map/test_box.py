"""The view on the map leads to the screen and back, stays on the map, and is exported with all that it shows."""

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyqtgraph.exporters import ImageExporter, SVGExporter
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtSvg import QSvgRenderer
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from tests.support.maps.sample_maps import busy_robots, house_of, rooms_of, shipped_map
from ui.model.shared.theme import LIGHT
from ui.windows.map import MapView
from ui.windows.map.box import MAX_SCALE


@pytest.fixture(scope="module")
def view(qapp: QApplication) -> Iterator[MapView]:
    view = shown(axes=False)
    yield view
    view.close()


def shown(*, axes: bool) -> MapView:
    house = shipped_map("arena8")
    view = MapView(LIGHT, axes=axes)
    view.resize(1000, 700)
    view.show_floor_plan(house_of(house))
    view.show_rooms(rooms_of(house))
    view.show_robots(busy_robots(house, 3))
    view.show()
    QApplication.processEvents()
    return view


metres = st.floats(-50.0, 50.0)


@given(metres, metres, st.floats(0.1, 10.0))
def test_to_the_screen_and_back(view: MapView, x: float, y: float, factor: float) -> None:
    view.box.zoom(factor, 1.0, 1.0)
    assert view.point(view.pixel(x, y)) == pytest.approx((x, y), abs=1e-6)


@given(st.lists(st.tuples(st.floats(0.02, 50.0), metres, metres), min_size=1, max_size=8))
def test_the_map_cannot_be_lost(view: MapView, moves: list[tuple[float, float, float]]) -> None:
    view.fit()
    whole = view.metres(1.0)
    for factor, x, y in moves:
        view.box.zoom(factor, x, y)
        view.box.translateBy(x=x, y=y)
        middle = QPointF(*view.box.middle)
        assert view.box.bounds.adjusted(-0.01, -0.01, 0.01, 0.01).contains(middle)
        assert pytest.approx(view.metres(1.0)) == 1.0 / MAX_SCALE or 1.0 / MAX_SCALE < view.metres(1.0) < 2.01 * whole


def test_north_is_up_and_the_map_lies_on_whole_pixels(view: MapView) -> None:
    view.fit()
    assert view.pixel(0.0, 2.0).y() < view.pixel(0.0, -2.0).y()
    view.box.zoom(1.37, 0.3, 0.2)
    view.box.translateBy(x=0.0123, y=0.0456)
    assert view.pixel(0.0, 0.0) == QPointF(view.pixel(0.0, 0.0).toPoint())


def test_another_size_keeps_the_scale_of_a_map_that_was_moved(qtbot: QtBot) -> None:
    view = shown(axes=False)
    qtbot.addWidget(view)
    view.box.zoom(2.0, 1.0, 1.0)
    middle, scale = view.box.middle, view.metres(1.0)
    for width, height in ((600, 700), (1000, 400), (1000, 700)):
        view.resize(width, height)
        QApplication.processEvents()
        assert view.box.middle == pytest.approx(middle, abs=0.01)
        assert view.metres(1.0) == pytest.approx(scale)


def test_the_picture_of_walls_and_rooms_is_kept_while_the_map_is_moved(view: MapView) -> None:
    view.fit()
    view.box.zoom(1.7, 0.3, 0.2)
    pictures = []
    for _ in range(20):
        view.box.translateBy(x=-view.metres(2.0), y=view.metres(1.0))
        view.grab()
        pictures.append(view._ground._picture)
    assert len({id(picture) for picture in pictures}) <= 2, "one at first, and one with a margin"


def colors(image: QImage) -> np.ndarray:
    """Return (70, 100, 3) colors of an image, made small."""
    small = image.scaled(100, 70, mode=Qt.TransformationMode.SmoothTransformation)
    plain = small.convertToFormat(QImage.Format.Format_RGBX8888)
    return np.array(plain.constBits()).reshape(plain.height(), plain.width(), 4)[:, :, :3].astype(int)


def test_files_show_what_the_window_shows(qtbot: QtBot) -> None:
    view = shown(axes=True)
    qtbot.addWidget(view)
    seen = view.grab(view.box.sceneBoundingRect().toRect()).toImage()
    vector = QImage(seen.size(), QImage.Format.Format_RGB32)
    vector.fill(Qt.GlobalColor.magenta)
    painter = QPainter(vector)
    QSvgRenderer(SVGExporter(view.box).export(toBytes=True)).render(painter, QRectF(vector.rect()))
    painter.end()
    for exported in (ImageExporter(view.box).export(toBytes=True), vector):
        assert np.mean(np.abs(colors(seen) - colors(exported)).max(axis=2) > 40) < 0.02


def test_a_researcher_has_axes_and_a_menu_that_exports(qtbot: QtBot) -> None:
    view = shown(axes=True)
    qtbot.addWidget(view)
    assert view.box.width() < view.width() and view.box.height() < view.height()
    at = QPoint(view.width() // 2, view.height() // 2)
    qtbot.mouseClick(view.viewport(), Qt.MouseButton.RightButton, pos=at)
    menu = view.box.getMenu(None)
    assert menu is not None and [action.text() for action in menu.actions()][-1] == "Export..."
    menu.close()


def test_a_participant_has_neither(view: MapView) -> None:
    assert view.box.rect() == QRectF(view.rect())
    assert view.box.getMenu(None) is None


def test_beside_an_axis_the_map_is_painted_to_its_last_pixel(qtbot: QtBot) -> None:
    view = shown(axes=True)
    qtbot.addWidget(view)
    shades = {LIGHT.unknown, LIGHT.line, LIGHT.window, LIGHT.panel, LIGHT.muted}
    for height in range(560, 570):
        view.resize(701, height)
        view.show_rooms(())
        view.invalidateScene()
        image = view.grab().toImage()
        bottom = int(view.box.mapRectToScene(view.box.rect()).bottom())
        right = int(view.box.mapRectToScene(view.box.rect()).right()) - 2
        for y in (bottom - 1, bottom):
            assert image.pixelColor(right, y).name() in shades, (height, y)
