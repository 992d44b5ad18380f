"""Facts for robots' arguments, collected from the game: the knowledge of each robot and of the team."""

import math
from collections.abc import Collection, Sequence
from functools import lru_cache

from sim.common.observations import TICKS_PER_SECOND
from thbridge.dialogue.robot_arguments import Misfit, WhatFacts, WhereFacts
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import Condition
from thbridge.hunt.game import GameState
from thbridge.hunt.planners import tours_begun_with
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.hunt.team_tour import PlanValue, TourStart, alternatives, best_team_tours
from thbridge.hunt.tour import Tour
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.keeper.advice.adviser import can_compare, start_of, tours_sending_first
from thbridge.roles.shared.participant_rules import Discussed, other_candidate

_SURE, _LOST = 1.0, 0.3
"""Confidence of a robot in the costs from its estimated position: if the robot is not lost, and if it is lost."""


def where_facts(
    state: GameState,
    discussed: Sequence[Discussed],
    robot: int,
    failed: Collection[Room],
    tick: int,
    rival: Room | None = None,
) -> WhereFacts:
    """Return a robot's facts about its next room.

    If there are too many rooms for a comparison of all plans, the joint plan is found by heuristic search. Then the
    value of another room is the value of the same plan after moving this room to the start of the robot's tour.

    Args:
        state: state of the game.
        discussed: matters of open dialogues and agreements.
        robot: index of the robot.
        failed: rooms that the robot recently failed to reach.
        tick: present tick.
        rival: room that the participant prefers, or None. The facts include the robots that would have no room after
            this choice.
    """
    here, row = state.robots[robot], state.costs_from(robot)
    taken = {room: other for room in state.free_rooms if (other := other_candidate(discussed, room, robot)) is not None}
    free = tuple(room for room in state.free_rooms if room not in taken)
    starts = {robot: TourStart(row, here.energy)}
    others = {number: start_of(state, discussed, number) for number in range(len(state.robots)) if number != robot}
    starts |= {number: start for number, start in others.items() if start is not None}
    proven = can_compare(free, starts)
    plans = _compared if proven else _searched
    values, tours = plans(state.started.costs, tuple(starts.values()), tuple(sorted(free)), state.started.identify_cost)
    by_robot = dict(zip(starts, values, strict=proven))
    busy = {number for number, tour in zip(starts, tours, strict=True) if tour.rooms}
    left_behind = {}
    if proven and rival is not None and rival in by_robot[robot]:
        left_behind[rival] = {
            other: state.robots[other].at for other in sorted(busy - _busy(state, starts, robot, rival, free))
        }
    first = {tour.rooms[0]: number for number, tour in zip(starts, tours, strict=True) if tour.rooms}
    return WhereFacts(
        robot=robot,
        here=here.at,
        energy=here.energy,
        costs={room: row[room.people] for room in free if math.isfinite(row[room.people])},
        left=tuple(state.free_rooms),
        under_way=taken,
        values=by_robot[robot],
        others={room: (number, starts[number].costs[room.people]) for room, number in first.items() if number != robot},
        failed=frozenset(failed),
        team_costs={
            number: {room: start.costs[room.people] for room in free if math.isfinite(start.costs[room.people])}
            for number, start in starts.items()
            if number != robot
        },
        team_values={number: of_robot for number, of_robot in by_robot.items() if number != robot},
        tour=tours[0].rooms,
        proven=proven,
        left_behind=left_behind,
        confidence=_LOST if here.condition is Condition.LOST else _SURE,
        at=tick / TICKS_PER_SECOND,
    )


def what_facts(
    state: GameState, robot: int, room: Room, kinds: Sequence[TreasureKind], tick: int, claimed: str = ""
) -> WhatFacts:
    """Return a robot's facts about a found treasure. All robots and participants know the list of treasures.

    Args:
        state: state of the game.
        robot: index of the robot.
        room: room of the treasure.
        kinds: all treasures.
        tick: present tick.
        claimed: name that the participant proposes; empty if there is none.
    """
    found = state.room(room)
    fitting = {
        kind.name for kind in kinds if all(kind.properties.get(name) == value for name, value in found.known.items())
    }
    return WhatFacts(
        room=room,
        energy=state.robots[robot].energy,
        picture_cost=state.started.picture_cost,
        naming_cost=state.started.identify_cost,
        names=tuple(sorted(fitting, key=str.casefold)),
        has_picture=found.image is not None,
        at=tick / TICKS_PER_SECOND,
        claimed=claimed,
        against=() if claimed in fitting else _against(state, room, kinds, claimed),
    )


def _against(state: GameState, room: Room, kinds: Sequence[TreasureKind], name: str) -> tuple[Misfit, ...]:
    """Return the properties that contradict a name: no treasure with this name has the known value."""
    found = state.room(room)
    listed = [kind.properties for kind in kinds if kind.name == name]
    return tuple(
        Misfit(each.phrase(found.known[each.name]), each.phrase(listed[0].get(each.name, "")), each.name in found.told)
        for each in state.started.properties
        if each.name in found.known
        and listed
        and all(of_kind.get(each.name) != found.known[each.name] for of_kind in listed)
    )


def _busy(state: GameState, starts: dict[int, TourStart], robot: int, room: Room, free: Collection[Room]) -> set[int]:
    """Return the robots with a next room, after one robot drives to a given room."""
    costs, visit = state.started.costs, state.started.identify_cost
    own = starts[robot]
    there = TourStart(costs.rows[room.people], max(own.energy - own.costs[room.people] - visit, 0.0))
    rest = tuple(other for other in free if other != room)
    tours = best_team_tours(costs, tuple({**starts, robot: there}.values()), rest, visit) if rest else ()
    return {robot} | {number for number, tour in zip(starts, tours, strict=False) if tour.rooms}


@lru_cache(maxsize=64)
def _compared(
    costs: CostMatrix, starts: tuple[TourStart, ...], rooms: tuple[Room, ...], visit: float
) -> tuple[tuple[dict[Room, PlanValue], ...], tuple[Tour, ...]]:
    """Return, by robot, the value of each next room, and the tours of the best plan that sends the first robot."""
    if not rooms:
        return tuple({} for _ in starts), tuple(Tour((), 0.0) for _ in starts)
    tours = tours_sending_first(TeamPlanner.JOINT, costs, starts, rooms, visit)
    return alternatives(costs, starts, rooms, visit), tours


@lru_cache(maxsize=64)
def _searched(
    costs: CostMatrix, starts: tuple[TourStart, ...], rooms: tuple[Room, ...], visit: float
) -> tuple[tuple[dict[Room, PlanValue], ...], tuple[Tour, ...]]:
    """Return the value of each next room of the first robot, and the tours of a good plan that sends this robot."""
    tours = tours_sending_first(TeamPlanner.JOINT, costs, starts, rooms, visit)
    payable = filter(starts[0].can_pay, rooms)
    begun = {room: tours_begun_with(costs, starts, tours, 0, room, visit) for room in payable}
    return ({room: PlanValue.of(changed) for room, changed in begun.items()},), tours
