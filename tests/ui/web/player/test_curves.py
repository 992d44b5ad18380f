"""Curves of the player differ from the recorded values by no more than they promise."""

import numpy as np
import pytest

from sim.numerics.float_array import FloatArray
from ui.web.player.curves import TIME_STEP, PlayedCurve, line, needed_samples, steps

UNIT, TOLERANCE = 0.001, 0.015


def _unpacked(curve: PlayedCurve, unit: float) -> tuple[FloatArray, FloatArray]:
    """Times and first values of a curve, as the page computes them."""
    return TIME_STEP * np.cumsum(curve.times), unit * np.cumsum(curve.values[0])


def _drive() -> FloatArray:
    """An hour of a robot that drives and rests, and is moved by hand once; 10 rows per second."""
    times = np.arange(0.0, 3600.0, 0.1)
    speed = np.where(times % 30.0 < 20.0, 0.5 * np.sin(times / 7.0), 0.0)
    places = np.cumsum(0.1 * speed) + np.where(times > 1800.0, 5.0, 0.0)
    return np.column_stack((times, places))


def test_interpolation_differs_from_no_row_by_more_than_the_tolerance() -> None:
    rows = _drive()
    times, values = _unpacked(line(rows, (UNIT,), (TOLERANCE,)), UNIT)
    differences = np.abs(np.interp(rows[:, 0], times, values) - rows[:, 1])
    assert differences.max() < TOLERANCE + UNIT
    assert len(times) < len(rows) / 10


def test_a_resting_robot_needs_two_samples() -> None:
    rows = np.column_stack((np.arange(1000.0), np.full(1000, 3.0)))
    assert needed_samples(rows, (TOLERANCE,)).tolist() == [0, 999]


def test_a_jump_keeps_the_samples_next_to_it() -> None:
    rows = np.column_stack((np.arange(10.0), [0.0] * 5 + [4.0] * 5))
    assert {4, 5} <= set(needed_samples(rows, (TOLERANCE,)).tolist())


def test_steps_keep_every_change_and_no_repetition() -> None:
    curve = steps(np.array([[0.0, 100.0], [1.0, 100.0], [2.0, 99.0], [3.0, 99.02], [4.0, 80.0]]), (0.1,))
    times, values = _unpacked(curve, 0.1)
    assert times.tolist() == pytest.approx([0.0, 2.0, 4.0])
    assert values.tolist() == pytest.approx([100.0, 99.0, 80.0])


@pytest.mark.parametrize("rows", [0, 1, 2])
def test_short_curves_are_complete(rows: int) -> None:
    table = np.column_stack((np.zeros(rows), np.arange(float(rows))))
    assert len(line(table, (UNIT,), (TOLERANCE,)).times) == rows
    assert len(steps(table, (UNIT,)).times) == rows
