import numpy as np
import pytest

from thbridge.analysis.comparison import RobotFigures, figures_of
from thbridge.analysis.report.report import NEVER, GoalAttempt, Report, Track
from thbridge.ros.messages.session_records import ScoreRecord

NONE = np.empty((0, 4))


def track(errors: np.ndarray, energy: np.ndarray, legs: tuple[GoalAttempt, ...] = ()) -> Track:
    return Track("robot1", NONE, NONE, errors, energy, legs, 12.5, NONE, NONE, NONE, NONE, (), NEVER, NEVER)


def report(tracks: tuple[Track, ...], score: ScoreRecord | None) -> Report:
    return Report(60.0, None, None, tracks, (), (), score, 0, ())


def test_the_figures_of_a_run() -> None:
    errors = np.column_stack((np.arange(101.0), np.linspace(0.0, 1.0, 101), np.zeros(101)))
    legs = (
        GoalAttempt(0.0, 10.0, "arrived", ""),
        GoalAttempt(12.0, 20.0, "no path", ""),
        GoalAttempt(21.0, 30.0, "arrived", ""),
    )
    figures = figures_of(
        report((track(errors, np.array([[0.0, 90.0], [5.0, 40.0]]), legs),), ScoreRecord(70, 3, 8, (40.0,)))
    )
    assert (figures.seconds, figures.score, figures.rooms_visited) == (60.0, 70, 3)
    (robot,) = figures.robots
    assert (robot.error_mean, robot.error_95) == (pytest.approx(0.5), pytest.approx(0.95))
    assert (robot.distance, robot.arrivals, robot.energy) == (12.5, (10.0, 30.0), 40.0)


def test_what_nobody_recorded_is_left_open() -> None:
    figures = figures_of(report((track(np.empty((0, 3)), np.empty((0, 2))),), None))
    assert (figures.score, figures.rooms_visited) == (None, None)
    assert figures.robots == (RobotFigures("robot1", None, None, 12.5, (), None),)
