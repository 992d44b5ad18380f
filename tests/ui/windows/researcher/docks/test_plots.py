"""Plots look like the figures they are given, and a click asks for its moment."""

import numpy as np
import pyqtgraph as pg
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from pytestqt.qtbot import QtBot

from tests.ui.windows.researcher.recording_times import place_of
from ui.model.shared.theme import DARK, LIGHT
from ui.windows.researcher.docks.plots import MOST_POINTS, PANELS, Plots, RobotCurves, thinned


@pytest.fixture
def plots(qtbot: QtBot) -> Plots:
    made = Plots(LIGHT, live=False)
    qtbot.addWidget(made)
    made.resize(400, 700)
    made.show()
    times = np.arange(0.0, 100.0, 0.5)
    figures = {panel.name: (times, np.sin(times)) for panel in PANELS} | {"band": (times, np.full_like(times, 0.2))}
    made.show_curves([RobotCurves(0, "robot 1", figures), RobotCurves(1, "robot 2", figures)], 100.0)
    return made


def test_every_panel_has_a_curve_of_every_robot(plots: Plots) -> None:
    assert {plots.points(panel.name, robot) for panel in PANELS for robot in (0, 1)} == {200}
    assert plots.points("error", 2) == 0


def test_a_click_asks_for_its_moment(plots: Plots, qtbot: QtBot) -> None:
    place = place_of(plots, 40.0)
    with qtbot.waitSignal(plots.seek) as asked:
        QTest.mouseClick(plots.canvas.viewport(), Qt.MouseButton.LeftButton, pos=place - QPoint(0, 20))
    assert asked.args[0] == pytest.approx(40.0, abs=1.0)


def test_the_cursor_the_selection_and_the_colours_are_seen(plots: Plots) -> None:
    before = plots.grab().toImage()
    plots.show_time(70.0)
    at_70 = plots.grab().toImage()
    plots.select(1)
    selected = plots.grab().toImage()
    plots.set_palette(DARK)
    dark = plots.grab().toImage()
    assert before != at_70 != selected != dark


def test_a_window_that_joined_late_says_so_where_its_curves_begin(plots: Plots) -> None:
    def words() -> list[str]:
        items = plots.canvas.scene().items()
        return [item.textItem.toPlainText() for item in items if isinstance(item, pg.InfLineLabel) and item.isVisible()]

    plots.show_joined(0.02)
    before = plots.grab().toImage()
    assert words() == []
    plots.show_joined(40.0)
    assert words() == ["connected\nat 40 s"]
    assert plots.grab().toImage() != before


@given(st.lists(st.floats(-1e3, 1e3) | st.just(float("nan")), min_size=1, max_size=300), st.integers(1, 60))
def test_thinning_keeps_the_extremes_and_the_order(values: list[float], times_as_long: int) -> None:
    many = np.tile(values, times_as_long)
    at = np.arange(len(many), dtype=np.float64)
    times, kept = thinned(at, many)
    assert len(times) <= max(MOST_POINTS + len(many) // (MOST_POINTS // 2) + 1, 2)
    assert (np.diff(times) > 0.0).all()
    if not np.isnan(many).all():
        assert np.nanmin(kept) == np.nanmin(many)
        assert np.nanmax(kept) == np.nanmax(many)
