"""Error codes of Nav2's results, for our reasons why a robot did not reach a goal.

Source: nav2_msgs of Jazzy and Kilted (ComputePathToPose, FollowPath, NavigateToPose, FollowWaypoints);
nav2_behavior_tree, bt_action_server_impl.hpp: the result has the smallest code that a planner or controller reported.
"""

from enum import IntEnum
from typing import NamedTuple

from sim.robot.navigator.goals import NoPathReason


class NavigationError(IntEnum):
    """Error codes in results of NavigateToPose. The codes from 9000 on exist since Kilted."""

    NONE = 0
    CONTROLLER_UNKNOWN = 100
    PATIENCE_EXCEEDED = 104
    FAILED_TO_MAKE_PROGRESS = 105
    NO_VALID_CONTROL = 106
    PLANNER_TF_ERROR = 202
    START_OUTSIDE_MAP = 203
    GOAL_OUTSIDE_MAP = 204
    START_OCCUPIED = 205
    GOAL_OCCUPIED = 206
    NO_VALID_PATH = 208
    UNKNOWN = 9000
    FAILED_TO_LOAD_BEHAVIOR_TREE = 9001
    TF_ERROR = 9002


class WaypointError(IntEnum):
    """Error codes in results of FollowWaypoints. The last two exist since Kilted."""

    NONE = 0
    UNKNOWN = 600
    NO_VALID_WAYPOINTS = 602
    STOP_ON_MISSED_WAYPOINT = 603


class ErrorResult(NamedTuple):
    """Error in a result: its code, and a sentence for people."""

    code: int = 0
    sentence: str = ""


NO_ERROR = ErrorResult()

_OF_REASON: dict[NoPathReason, NavigationError] = {
    "start_outside": NavigationError.START_OUTSIDE_MAP,
    "goal_outside": NavigationError.GOAL_OUTSIDE_MAP,
    "start_occupied": NavigationError.START_OCCUPIED,
    "goal_occupied": NavigationError.GOAL_OCCUPIED,
    "no_way": NavigationError.NO_VALID_PATH,
    "robots_in_the_way": NavigationError.PATIENCE_EXCEEDED,
    "blocked_by_obstacle": NavigationError.NO_VALID_CONTROL,
    "stuck": NavigationError.FAILED_TO_MAKE_PROGRESS,
    "lost": NavigationError.TF_ERROR,
}

_IN_JAZZY = {
    NavigationError.UNKNOWN: NavigationError.CONTROLLER_UNKNOWN,
    NavigationError.FAILED_TO_LOAD_BEHAVIOR_TREE: NavigationError.NONE,
    NavigationError.TF_ERROR: NavigationError.PLANNER_TF_ERROR,
}
"""Codes of Jazzy in the place of codes that Jazzy does not have."""


def navigation_error(distribution: str, reason: NoPathReason | NavigationError) -> NavigationError:
    """Return the code for a reason, or for a code of Kilted, in a distribution."""
    code = reason if isinstance(reason, NavigationError) else _OF_REASON.get(reason, NavigationError.UNKNOWN)
    return _IN_JAZZY.get(code, code) if distribution == "jazzy" else code


def waypoint_error(distribution: str, code: WaypointError) -> WaypointError:
    """Return a code of Kilted in a distribution. Jazzy has no codes for missing and missed waypoints."""
    return WaypointError.NONE if distribution == "jazzy" and code > WaypointError.UNKNOWN else code
