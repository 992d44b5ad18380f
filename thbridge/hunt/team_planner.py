"""The planners of a team that there are, by name."""

from enum import StrEnum


class TeamPlanner(StrEnum):
    """Planner of which robot visits which room next."""

    JOINT = "joint"
    """The joint plan of the team: most rooms, then least energy."""
    NEAREST = "nearest"
    """Each robot goes to the room nearest to it."""
    GREEDY = "greedy"
    """Of all moves of all robots the cheapest is made first."""
    TOUR = "tour"
    """Each robot plans the best tour of all rooms left for itself alone, as in 2016."""
    AUCTION = "auction"
    """Robots bid for rooms what these add to their tours; the lowest bid wins, room by room."""
