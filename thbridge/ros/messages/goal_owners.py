"""Owners of goals, and the numbers of their goals in recordings.

A goal of a navigator has an owner and a number. Each owner counts its own goals. Recordings, requests of watchers and
ids of goals in ROS have one number instead of these two: each owner has its own range of numbers.
"""

from enum import StrEnum


class GoalOwner(StrEnum):
    """Party that sets goals and counts them. `WINDOW` is used until the window's session has counted the goal."""

    GAME = ""
    ROS_CLIENT = "ROS client"
    WINDOW = "window"
    RESEARCHER = "researcher"
    GROUND_STATION = "ground station"
    STRANGER = "client of another program"


_FIRST = {
    GoalOwner.STRANGER: -1,
    GoalOwner.GAME: 0,
    GoalOwner.ROS_CLIENT: 1_000_000_000,
    GoalOwner.WINDOW: 1_500_000_000,
    GoalOwner.RESEARCHER: 2_000_000_000,
    GoalOwner.GROUND_STATION: 3_000_000_000,
}
"""Recorded number of each owner's goal 0. The numbers are in ascending order."""


def recorded_number(owner: str, number: int) -> int:
    """Return the number that a goal has in recordings; `number` is the owner's own number of the goal."""
    return _FIRST[GoalOwner(owner)] + number


def owned_number(recorded: int) -> tuple[GoalOwner, int]:
    """Return the owner of a goal with this number in recordings, and the owner's own number of the goal."""
    owner = next((owner for owner, first in reversed(_FIRST.items()) if first <= recorded), GoalOwner.STRANGER)
    return owner, recorded - _FIRST[owner]
