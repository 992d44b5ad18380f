"""Two runs side by side: what was gained and lost by changing a study."""

from dataclasses import dataclass

import numpy as np

from thbridge.analysis.report.gathering import OUTCOMES
from thbridge.analysis.report.values import Report, Track
from thbridge.ros.messages.goal_status import GoalStatusCode


@dataclass(frozen=True, slots=True)
class RobotFigures:
    """One robot in one run; a figure is None where nothing was recorded that tells it.

    Attributes:
        name: "robot1".
        error_mean: metres between where it was and where it believed to be.
        error_95: metres that 95 % of these errors do not exceed.
        distance: metres driven.
        arrivals: seconds at which it arrived somewhere.
        energy: that it has left.
    """

    name: str
    error_mean: float | None
    error_95: float | None
    distance: float
    arrivals: tuple[float, ...]
    energy: float | None


@dataclass(frozen=True, slots=True)
class RunFigures:
    """One run.

    Attributes:
        seconds: session time.
        score: points; None in a recording without a game.
        rooms_visited: how many; likewise.
        robots: in order.
    """

    seconds: float
    score: int | None
    rooms_visited: int | None
    robots: tuple[RobotFigures, ...]


def figures_of(report: Report) -> RunFigures:
    """The figures of a recording."""
    score = report.score
    return RunFigures(
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
        tuple(leg.end for leg in track.attempts if leg.outcome == OUTCOMES[GoalStatusCode.SUCCEEDED]),
        float(track.energy[-1, 1]) if len(track.energy) else None,
    )
