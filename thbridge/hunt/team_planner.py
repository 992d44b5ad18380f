"""Names of the planners for a team."""

from enum import StrEnum


class TeamPlanner(StrEnum):
    """Planner that decides which robot visits which room next."""

    JOINT = "joint"
    """Joint plan of the team. It has the largest number of rooms and, among these plans, the least energy."""
    NEAREST = "nearest"
    """Each robot drives to its nearest room."""
    GREEDY = "greedy"
    """The next move is the cheapest of all robots' moves."""
    TOUR = "tour"
    """Each robot plans its best tour of all remaining rooms without regard to other robots, as in 2016."""
    AUCTION = "auction"
    """Robots bid for rooms. A bid is the additional energy for a tour with the room. The lowest bid wins the room."""
