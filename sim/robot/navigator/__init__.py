"""move_base: from a goal to commands."""

from sim.robot.navigator.goals import Arrived, Cancelled, Goal, NoPath, Result
from sim.robot.navigator.move_base import NEARER, STALEMATE, Navigator
from sim.robot.navigator.navigation import Navigation, NavigatorState

__all__ = [
    "NEARER",
    "STALEMATE",
    "Arrived",
    "Cancelled",
    "Goal",
    "Navigation",
    "Navigator",
    "NavigatorState",
    "NoPath",
    "Result",
]
