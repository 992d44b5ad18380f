"""Figures: what is in them, that they are the same every time, and what is said when there is nothing to draw."""

from dataclasses import replace
from io import BytesIO
from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from PIL import Image

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid
from sim.common.robot_colors import robot_color
from tests.thbridge.analysis.reported_drive import session
from thbridge.analysis.plot.figures import SIGMAS, draw
from thbridge.analysis.plot.kinds import FigureKind
from thbridge.analysis.plot.style import ONE_COLUMN, TWO_COLUMNS, FigureFormat, FigureStyle
from thbridge.analysis.report.builder import read_report
from thbridge.analysis.report.report import Report, TimelineEntry, WayMade
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import RoomNames

LOOKS = (ONE_COLUMN, TWO_COLUMNS)


@pytest.fixture(scope="module")
def report() -> Report:
    return session(2, 400)


def drawn(what: FigureKind, report: Report, look: FigureStyle = TWO_COLUMNS) -> Figure:
    figure = draw(what, report, look)
    assert isinstance(figure, Figure)
    return figure


@pytest.mark.parametrize("look", LOOKS)
@pytest.mark.parametrize("what", FigureKind)
def test_everything_can_be_plotted_of_a_session_of_ours(report: Report, what: FigureKind, look: FigureStyle) -> None:
    for axes in drawn(what, report, look).axes:
        assert axes.lines or axes.patches or axes.collections
        assert axes.get_ylabel() or axes.get_yticklabels()


def test_print_has_300_dots_an_inch(report: Report) -> None:
    image = Image.open(BytesIO(ONE_COLUMN.rendered(drawn(FigureKind.PATHS, report, ONE_COLUMN), FigureFormat.PNG)))
    assert image.width == int(ONE_COLUMN.width * 300)


@pytest.mark.parametrize("kind", FigureFormat)
def test_the_same_report_gives_the_same_bytes(report: Report, kind: FigureFormat) -> None:
    one, other = (TWO_COLUMNS.rendered(drawn(FigureKind.ERROR, report), kind) for _ in range(2))
    assert one == other
    assert b"Matplotlib" not in one
    if kind is FigureFormat.SVG:
        ElementTree.fromstring(one)


@pytest.mark.parametrize("what", FigureKind)
def test_what_is_missing_is_told(what: FigureKind) -> None:
    refused = draw(what, read_report([]), TWO_COLUMNS)
    assert isinstance(refused, RequestRefused)
    assert "Nothing to plot" in refused.sentence


def test_the_band_is_what_the_localiser_admits(report: Report) -> None:
    axes = drawn(FigureKind.ERROR, report).axes[0]
    (band,) = axes.collections
    top = band.get_paths()[0].vertices[:, 1].max()
    # The drawn team admits variances of 0.01 and 0.02 m2.
    assert top == pytest.approx(100 * SIGMAS * np.sqrt(0.03))
    assert axes.lines[0].get_ydata().max() == pytest.approx(100 * report.tracks[0].errors[:, 1].max())


def test_odometry_alone_is_drawn_without_the_map_it_is_not_in(report: Report) -> None:
    nothing = np.empty((0, 4))
    tracks = tuple(replace(track, truth=nothing, estimate=nothing) for track in report.tracks)
    axes = drawn(FigureKind.PATHS, replace(report, tracks=tracks)).axes[0]
    assert any(line.get_linestyle() == "--" and len(line.get_xdata()) > 10 for line in axes.lines)
    assert "odometry" in [text.get_text() for text in axes.get_legend().get_texts()]
    assert not axes.images


def test_unknown_ground_about_a_map_is_cut_off(report: Report) -> None:
    cells = np.full((400, 600), -1, dtype=np.int8)
    cells[100:200, 300:500] = 0
    grid = OccupancyGrid(cells, 0.1, Pose2(-30.0, -20.0, 0.0))
    axes = drawn(FigureKind.PATHS, replace(report, tracks=(), grid=grid)).axes[0]
    assert (axes.get_xlim(), axes.get_ylim()) == (pytest.approx((0.0, 20.0)), pytest.approx((-10.0, 0.0)))


def test_goals_have_the_number_of_their_room(report: Report) -> None:
    leg = report.tracks[0].attempts[0]
    departed = TimelineEntry(leg.start, "departed", "robot 1", 7, "")
    axes = drawn(FigureKind.TIMELINE, replace(report, timeline=(departed,))).axes[0]
    assert "7" in [text.get_text() for text in axes.texts]


def test_the_name_of_a_room_stands_beside_its_number_where_it_fits(report: Report) -> None:
    leg = report.tracks[0].attempts[0]
    departed = TimelineEntry(leg.start, "departed", "robot 1", 7, "")
    for name, told in (("Bath", "7 (Bath)"), ("A very large room " * 9, "7")):
        named = replace(report, timeline=(departed,), rooms=RoomNames({7: name}))
        assert told in [text.get_text() for text in drawn(FigureKind.TIMELINE, named).axes[0].texts]


def test_ways_made_are_thin_bars_in_the_colour_of_the_robot_that_goes_first(report: Report) -> None:
    first, second = report.tracks
    tracks = (replace(first, ways_made=(WayMade(1.0, 3.5, second.name),)), second)
    axes = drawn(FigureKind.TIMELINE, replace(report, tracks=tracks)).axes[0]
    (bar,) = [bar for bar in axes.patches if bar.get_width() == 2.5]
    assert (bar.get_x(), to_hex(bar.get_facecolor())) == (1.0, robot_color(1).lower())
    assert any("makes way" in text.get_text() for text in axes.get_legend().get_texts())


@pytest.mark.parametrize(("duration", "labels"), [(3.0, "0:01"), (60.0, "0:10"), (400.0, "1:00"), (7000.0, "30:00")])
def test_times_are_round_as_clocks_are(report: Report, duration: float, labels: str) -> None:
    axes = drawn(FigureKind.ENERGY, replace(report, duration=duration)).axes[0]
    ticks = axes.xaxis.get_major_locator().tick_values(0.0, duration)
    assert labels in [axes.xaxis.get_major_formatter()(tick, None) for tick in ticks]
