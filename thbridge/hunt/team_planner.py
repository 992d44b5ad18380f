"""Names of the planners of a team."""

from enum import StrEnum


class TeamPlanner(StrEnum):
    """Planner that decides which robot visits which room next."""

    JOINT = "joint"
    """The joint plan of the team: most rooms, then least energy."""
    NEAREST = "nearest"
    """Each robot goes to its nearest room."""
    GREEDY = "greedy"
    """The cheapest of all robots' moves comes first."""
    TOUR = "tour"
    """Each robot plans, only for itself, the best tour of all remaining rooms, as in 2016."""
    AUCTION = "auction"
    """Robots bid for rooms with the energy that these add to their tours; the lowest bid wins, room by room."""
