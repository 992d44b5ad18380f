"""move_base: from a goal to commands."""

from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, GoalResult, NoPath
from sim.robot.navigator.move_base import PROGRESS_DISTANCE, PROGRESS_TIMEOUT, Navigator
from sim.robot.navigator.navigation import Navigation, NavigatorState

__all__ = [
    "PROGRESS_DISTANCE",
    "PROGRESS_TIMEOUT",
    "Cancelled",
    "Goal",
    "GoalReached",
    "GoalResult",
    "Navigation",
    "Navigator",
    "NavigatorState",
    "NoPath",
]
