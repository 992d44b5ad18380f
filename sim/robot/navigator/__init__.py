"""move_base: from a goal to commands."""

from sim.robot.navigator.goals import Cancelled, Goal, GoalReached, GoalResult, NoPath
from sim.robot.navigator.move_base import Navigator
from sim.robot.navigator.navigation import Navigation, NavigatorState
from sim.robot.navigator.progress import PROGRESS_DISTANCE, PROGRESS_TIMEOUT

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
