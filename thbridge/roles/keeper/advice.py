"""Advice of a robot about where to go: its first room in the joint plan of the team, and the reason for it."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import lru_cache

from sim.common.robot_numbers import robot_name
from thbridge.hunt import rules
from thbridge.hunt.costs import CostMatrix, energy_text
from thbridge.hunt.events import Commander
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_tour import TourStart, best_team_tours
from thbridge.hunt.tour import Tour, why_no_tour
from thbridge.roles.participant_rules import Discussed, Situation, free_to_discuss

MOST_ROOMS_ADVISED = 12
"""Greatest number of rooms left for which robots plan together: a plan has to be there within a tick."""


@dataclass(frozen=True, slots=True)
class Advice:
    """A room that a robot suggests, and its reason as part of a sentence: "no other room costs me less"."""

    room: Room
    reason: str


def advise(state: GameState, discussed: Sequence[Discussed], robot: int) -> Advice | RequestRefused:
    """Return the advice of a robot, or a refusal (`NoTour`) when there is no room that it could suggest.

    It plans for all robots that the participant can send: those under way, and those that are about to be sent, go on
    from there with the energy that is left to them once they have named what they find. Rooms that other robots have
    dialogues about are theirs. Of more rooms than a joint plan can share out, the robot plans its own tour.
    """
    adviser, costs = state.robots[robot], state.started.costs
    free = tuple(free_to_discuss(Situation(state, tuple(discussed)), robot))
    refused = why_no_tour(state.costs_from(robot), adviser.at, free, adviser.energy)
    if refused is not None:
        return refused
    starts = {robot: TourStart(state.costs_from(robot), adviser.energy)}
    if len(free) <= MOST_ROOMS_ADVISED:
        others = {number: _start(state, discussed, number) for number in range(len(state.robots)) if number != robot}
        starts |= {number: start for number, start in others.items() if start is not None}
    tours = _tours(costs, tuple(starts.values()), free, state.started.identify_cost)
    room = tours[0].rooms[0]
    return Advice(room, _reason(starts[robot].costs, room, free, dict(zip(starts, tours, strict=True)), robot))


def _reason(row: Sequence[float], room: Room, free: Collection[Room], tours: dict[int, Tour], robot: int) -> str:
    """Return the reason for going to a room next, as part of a sentence.

    Args:
        row: energy from the robot's place to every place.
        room: the room to go to.
        free: rooms that are left.
        tours: planned tours, by robot.
        robot: the robot that speaks.
    """
    nearest = min(free, key=lambda other: (row[other.people], other))
    if row[room.people] <= row[nearest.people]:
        return "no other room costs me less"
    taker = next((number for number, tour in tours.items() if nearest in tour.rooms), None)
    if taker is None:
        return f"{nearest} costs me less, but so we can reach more rooms"
    if taker != robot:
        return f"{nearest} costs me less, but {robot_name(taker)} is better placed for it"
    return f"{nearest} costs me less now, but my whole round costs less with {room} first"


def reason_by_cost(cost: float) -> str:
    """Return a reason for a room that somebody else has chosen in the robot's place."""
    return f"it costs me {energy_text(cost)}"


def _start(state: GameState, discussed: Sequence[Discussed], number: int) -> TourStart | None:
    """Return where another robot will be sent from next, or None if the participant cannot send it."""
    robot, costs, visit = state.robots[number], state.started.costs, state.started.identify_cost
    if rules.unable(state, number) or rules.commanded_by_other(state, number, Commander.PARTICIPANT):
        return None
    row, energy = state.costs_from(number), robot.energy
    talk = next((about.room for about in discussed if (about.robot, about.matter) == (number, "select-room")), None)
    if robot.bound_for is not None:
        row, energy = costs.rows[robot.bound_for.people], energy - visit
    elif talk is not None:
        row, energy = costs.rows[talk], energy - row[talk] - visit
    elif state.has_room(robot.at) and state.decider(robot.at) == number and not state.room(robot.at).is_decided:
        energy -= visit
    return TourStart(row, max(energy, 0.0))


@lru_cache(maxsize=16)
def _tours(costs: CostMatrix, starts: tuple[TourStart, ...], rooms: tuple[Room, ...], visit: float) -> tuple[Tour, ...]:
    """Return `best_team_tours` for the first robot; remembered, since a wizard's advice is shown anew in every tick."""
    return best_team_tours(costs, starts, rooms, visit, sent=0)
