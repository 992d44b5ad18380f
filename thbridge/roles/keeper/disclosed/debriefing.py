"""Debrief of participants after a game: the treasures of all rooms, and the best possible score."""

from collections.abc import Sequence

from thbridge.hunt.game import GameState
from thbridge.hunt.team_tour import TourStart, best_score, most_rooms_shared_out
from thbridge.roles.keeper.disclosed.briefing import Briefing
from thbridge.roles.shared.view import Debrief, RoomDebrief


def debrief_of(state: GameState, from_starts: Sequence[Sequence[float]], briefing: Briefing) -> Debrief:
    """Return the debrief of an ended game.

    Args:
        state: state of the game.
        from_starts: energy from each robot's start to each place, by number (0 is the corridor, rooms start at 1).
        briefing: briefing of the study's participants.
    """
    treasures = state.treasures
    if treasures is None or not briefing.answers:
        return Debrief(farewell=briefing.farewell)
    points = {room: kind.points for room, kind in zip(state.started.costs.rooms, treasures, strict=True)}
    best = None
    if len(points) <= most_rooms_shared_out(len(from_starts)):
        starts = [TourStart(tuple(row), state.started.energy) for row in from_starts]
        best = best_score(state.started.costs, starts, points, state.started.identify_cost)
    rooms = (RoomDebrief(room.people, kind.name, kind.points) for room, kind in zip(points, treasures, strict=True))
    return Debrief(tuple(rooms), best, briefing.farewell)
