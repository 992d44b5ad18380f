"""Costs around obstacles, cell by cell against the rule written down naively."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.parameters import InflationParameters
from sim.robot.costmap.costs import INSCRIBED, LETHAL, UNKNOWN, Window
from sim.robot.costmap.inflation import InflationLayer, cost_at


def by_the_rule(costs, parameters, resolution, inscribed):
    """Every cell looks at every lethal cell: the nearest decides, if it lies within the radius in whole cells."""
    rows, cols = costs.shape
    reach = math.ceil(parameters.inflation_radius / resolution)
    lethal = [(r, c) for r in range(rows) for c in range(cols) if costs[r, c] == LETHAL]
    inflated = costs.copy()
    for r in range(rows):
        for c in range(cols):
            cells = min((math.hypot(r - i, c - j) for i, j in lethal), default=math.inf)
            if cells > reach or reach == 0:
                continue
            distance = cells * resolution
            if cells == 0:
                cost = LETHAL
            elif distance <= inscribed:
                cost = INSCRIBED
            else:
                cost = int(252 * math.exp(-parameters.cost_scaling_factor * (distance - inscribed)))
            if costs[r, c] == UNKNOWN:
                takes = cost > 0 if parameters.inflate_unknown else cost >= INSCRIBED
                inflated[r, c] = cost if takes else UNKNOWN
            else:
                inflated[r, c] = max(cost, costs[r, c])
    return inflated


@st.composite
def scenes(draw):
    rows, cols = draw(st.integers(1, 20)), draw(st.integers(1, 20))
    kinds = st.sampled_from([0] * 12 + [LETHAL, LETHAL, UNKNOWN, INSCRIBED, 77])
    cells = draw(st.lists(kinds, min_size=rows * cols, max_size=rows * cols))
    parameters = InflationParameters(
        inflation_radius=draw(st.sampled_from([0.0, 0.04, 0.05, 0.12, 0.3, 0.55]) | st.floats(0.0, 1.0)),
        cost_scaling_factor=draw(st.floats(0.0, 100.0)),
        inflate_unknown=draw(st.booleans()),
    )
    return np.array(cells, np.uint8).reshape(rows, cols), parameters, draw(st.sampled_from([0.02, 0.05, 0.1]))


@given(scenes(), st.floats(0.0, 0.6))
def test_every_cell_has_the_cost_that_costmap_2d_publishes(scene, inscribed):
    costs, parameters, resolution = scene
    expected = by_the_rule(costs, parameters, resolution, inscribed)
    InflationLayer(parameters, resolution, inscribed).write(costs, (0, 0), Window(0, 0, *costs.shape))
    assert np.array_equal(costs, expected)


@settings(max_examples=50, deadline=None)
@given(scenes(), st.floats(0.0, 0.6), st.integers(-5, 5), st.data())
def test_a_window_gets_the_costs_that_the_whole_would_get_there_and_nothing_else_changes(scene, inscribed, at, data):
    costs, parameters, resolution = scene
    rows, cols = costs.shape
    row, col = data.draw(st.integers(0, rows - 1)), data.draw(st.integers(0, cols - 1))
    row_end, col_end = data.draw(st.integers(row + 1, rows)), data.draw(st.integers(col + 1, cols))
    expected = costs.copy()
    inside = np.s_[row:row_end, col:col_end]
    expected[inside] = by_the_rule(costs, parameters, resolution, inscribed)[inside]
    layer = InflationLayer(parameters, resolution, inscribed)
    layer.write(costs, (at, -at), Window(row + at, col - at, row_end + at, col_end - at))
    assert np.array_equal(costs, expected)


def test_cells_within_the_radius_in_whole_cells_get_costs_though_they_lie_beyond_it_in_metres():
    costs = np.zeros((1, 9), np.uint8)
    costs[0, 0] = LETHAL
    InflationLayer(InflationParameters(inflation_radius=0.12, cost_scaling_factor=1.0), 0.05, 0.05).write(
        costs, (0, 0), Window(0, 0, 1, 9)
    )
    assert costs[0].tolist() == [254, 253, int(252 * math.exp(-0.05)), int(252 * math.exp(-0.1)), 0, 0, 0, 0, 0]


@pytest.mark.parametrize(("distance", "cost"), [(0.0, 254), (0.26, 253), (0.36, int(252 * math.exp(-1.0)))])
def test_cost_falls_as_costmap_2d_says(distance, cost):
    assert cost_at(distance, 0.26, 10.0) == cost
