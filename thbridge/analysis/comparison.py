"""Figures of a run, for comparing two runs of different studies."""

from dataclasses import dataclass

import numpy as np

from thbridge.analysis.report.report import Report, Track
from thbridge.analysis.report.robot_messages import OUTCOMES
from thbridge.ros.messages.goal_status import GoalStatusCode


@dataclass(frozen=True, slots=True)
class RobotFigures:
    """Figures of one robot in one run; None for data that were not recorded.

    Attributes:
        name: "robot1".
        error_mean: mean distance between the true and the estimated position, meters.
        error_95: 95 % quantile of this distance, meters.
        distance: distance driven, meters.
        arrivals: times of arrivals at goals, seconds.
        energy: energy left at the end.
    """

    name: str
    error_mean: float | None
    error_95: float | None
    distance: float
    arrivals: tuple[float, ...]
    energy: float | None


@dataclass(frozen=True, slots=True)
class RunFigures:
    """Figures of one game in one run.

    Attributes:
        game: number of the game; None in a recording without a game.
        seconds: duration in simulated time, seconds.
        score: points; None in a recording without a game.
        rooms_visited: number of rooms visited; None in a recording without a game.
        robots: figures of the robots, in order.
    """

    game: int | None
    seconds: float
    score: int | None
    rooms_visited: int | None
    robots: tuple[RobotFigures, ...]


def figures_of(report: Report) -> RunFigures:
    """Return the figures of a report."""
    score = report.score
    return RunFigures(
        report.game,
        report.duration,
        None if score is None else score.score,
        None if score is None else score.visited,
        tuple(_robot(track) for track in report.tracks),
    )


def _robot(track: Track) -> RobotFigures:
    errors = track.errors[:, 1]
    return RobotFigures(
        track.name,
        float(errors.mean()) if len(errors) else None,
        float(np.quantile(errors, 0.95)) if len(errors) else None,
        track.distance,
        tuple(attempt.end for attempt in track.attempts if attempt.outcome == OUTCOMES[GoalStatusCode.SUCCEEDED]),
        float(track.energy[-1, 1]) if len(track.energy) else None,
    )
