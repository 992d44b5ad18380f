import math

import pyarrow as pa
import pytest

from thbridge.analysis.plot.style import ONE_COLUMN
from thbridge.batch.bands import BandKind
from thbridge.batch.figures import FigureAxes, curves_of, draw_curves

TABLE = pa.table(
    {
        "noise": [0.5, 0.5, 0.5, 0.1, 0.1, 0.1],
        "robots": [1, 1, 1, 1, 1, 2],
        "score": [10, 20, 30, 40, None, 7],
    }
)


def test_means_have_students_intervals_and_levels_their_order() -> None:
    curves = curves_of(TABLE, FigureAxes("score", "noise", lines="robots"))
    assert [(place, [point.level for point in points]) for place, points in curves.items()] == [
        (("", "1"), [0.1, 0.5]),
        (("", "2"), [0.1]),
    ]
    single, several = curves["", "1"]
    assert (single.games, single.mean, single.low, single.high) == (1, 40.0, 40.0, 40.0)
    # t(0.975; 2) = 4.302653, by any table of it.
    half = 4.302653 * 10 / math.sqrt(3)
    assert (several.games, several.mean) == (3, 20.0)
    assert (several.low, several.high) == pytest.approx((20 - half, 20 + half), rel=1e-6)


def test_a_bootstrap_draws_the_same_again_and_from_the_games_alone() -> None:
    axes = FigureAxes("score", "noise", band=BandKind.BOOTSTRAP)
    (_, several), (_, again) = curves_of(TABLE, axes)["", ""], curves_of(TABLE, axes)["", ""]
    assert several == again
    assert 10.0 <= several.low < several.mean < several.high <= 30.0


def test_a_panel_for_each_level_and_a_logarithmic_axis() -> None:
    axes = FigureAxes("score", "noise", panels="robots", is_log=True)
    figure = draw_curves(curves_of(TABLE, axes), axes, ONE_COLUMN)
    assert [panel.get_title(loc="left") for panel in figure.axes] == ["robots = 1", "robots = 2"]
    assert {panel.get_xscale() for panel in figure.axes} == {"log"}
