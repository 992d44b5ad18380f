"""Facts of robots: every number that a robot says is so, and none comes from what is hidden."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise, permutations, product

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from msgspec import structs

from tests.support.hunts.random_hunts import random_hunt
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.explanations import explain, questions
from thbridge.dialogue.moves import Question
from thbridge.dialogue.propositions import (
    CostOfOther,
    CostsMore,
    DearerPlan,
    EnergyCost,
    EnergyLevel,
    FewerRooms,
    LeftBehind,
    LessThan,
    NextRoom,
    ShorterPlan,
    TeamPlan,
)
from thbridge.dialogue.robot_arguments import WhatFacts, WhereFacts, what, where
from thbridge.hunt import game
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import GameStarted
from thbridge.hunt.game import GameState
from thbridge.hunt.planners import searched_tours, tours_begun_with
from thbridge.hunt.properties import OF_2016
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_tour import PlanValue, TourStart
from thbridge.hunt.treasures import TreasureKind
from thbridge.roles.keeper.advice.robot_facts import what_facts, where_facts
from thbridge.roles.shared.participant_rules import Discussed

ROOMS, VISIT = 4, 3.0
costs_of_a_move = st.integers(5, 60).map(float)


@st.composite
def states(draw: st.DrawFn) -> GameState:
    size = ROOMS + 1
    rows = tuple(
        tuple(math.inf if here in {0, at} else draw(costs_of_a_move) for here in range(size)) for at in range(size)
    )
    started = GameStarted(
        seed=1,
        game=1,
        robots=2,
        energy=float(draw(st.integers(20, 200))),
        picture_cost=10.0,
        identify_cost=VISIT,
        wrong_share=1.0,
        costs=CostMatrix(rows),
        properties=OF_2016,
    )
    return structs.replace(game.begin(started), agreed=True)


def plans(state: GameState, rooms: tuple[int, ...]) -> Iterator[tuple[tuple[tuple[int, ...], ...], float]]:
    """All plans of two robots: their tours, and the energy of all moves."""
    for owners in product((None, 0, 1), repeat=len(rooms)):
        shares = [[room for room, owner in zip(rooms, owners, strict=True) if owner == robot] for robot in (0, 1)]
        for tours in product(*(permutations(share) for share in shares)):
            spent = [cost_of(state, robot, tour) for robot, tour in enumerate(tours)]
            used = [cost + VISIT * max(len(tour) - 1, 0) for cost, tour in zip(spent, tours, strict=True)]
            if all(energy <= robot.energy for energy, robot in zip(used, state.robots, strict=True)):
                yield tours, sum(spent)


def cost_of(state: GameState, robot: int, tour: tuple[int, ...]) -> float:
    places = (state.robots[robot].at.people, *tour)
    return sum(state.started.costs.rows[a][b] for a, b in pairwise(places))


def best_plan(state: GameState, robot: int, first: int) -> PlanValue:
    """The most rooms, then the least energy, of all plans in which a robot goes to a room first."""
    found = [
        (-sum(map(len, tours)), cost)
        for tours, cost in plans(state, tuple(range(1, ROOMS + 1)))
        if tours[robot][:1] == (first,)
    ]
    rooms, cost = min(found)
    return PlanValue(-rooms, cost)


def best_plans(state: GameState, robot: int, first: int) -> Iterator[tuple[tuple[int, ...], ...]]:
    """The tours of all plans that are as good as the best one in which a robot goes to a room first."""
    best = best_plan(state, robot, first)
    for tours, cost in plans(state, tuple(range(1, ROOMS + 1))):
        if tours[robot][:1] == (first,) and sum(map(len, tours)) == best.rooms and cost <= best.cost + 1e-9:
            yield tours


@settings(max_examples=25)
@given(states(), st.integers(0, 1), st.data())
def test_every_number_in_an_explanation_is_recomputed(state: GameState, robot: int, draw: st.DataObject) -> None:
    facts = where_facts(state, (), robot, (), tick=50)
    assume(facts.values)
    wanted = draw.draw(st.sampled_from(sorted(facts.values)))
    facts = where_facts(state, (), robot, (), tick=50, rival=wanted)
    evidence = where(facts, rival=wanted)
    asked = questions(facts, evidence, Literal(NextRoom(robot, wanted)))
    assert asked
    for enquiry in asked:
        for literal in explain(enquiry, facts, evidence).because:
            assert literal.holds
            match literal.proposition:
                case TeamPlan(other, room, rooms, energy):
                    value = best_plan(state, other, room.people)
                    assert (rooms, round(energy, 6)) == (value.rooms, round(value.cost, 6))
                case EnergyCost(_, room, energy):
                    assert energy == cost_of(state, robot, (room.people,))
                case CostOfOther(other, room, energy):
                    assert energy == cost_of(state, other, (room.people,))
                case EnergyLevel(energy):
                    assert energy == state.robots[robot].energy
                case DearerPlan(room, instead, energy):
                    one, other = (best_plan(state, robot, each.people) for each in (room, instead))
                    assert one.rooms == other.rooms and round(one.cost - other.cost - energy, 6) == 0.0
                case ShorterPlan(room, instead, rooms):
                    one, other = (best_plan(state, robot, each.people) for each in (room, instead))
                    assert other.rooms - one.rooms == rooms
                case LeftBehind(other, place, room):
                    assert place == state.robots[other].at
                    assert any(not tours[other] for tours in best_plans(state, robot, room.people))
                case LessThan() | FewerRooms() as compared:
                    assert compared.is_true


@pytest.mark.parametrize(("rooms", "energy"), [(18, 40.0), (20, 60.0), (30, 300.0)])
def test_of_many_rooms_it_tells_what_the_team_reaches_and_compares_no_plans(rooms: int, energy: float) -> None:
    costs, _ = random_hunt(rooms, 2, energy, seed=rooms)
    started = GameStarted(1, 1, 2, energy, 10.0, VISIT, 1.0, costs, OF_2016)
    state = structs.replace(game.begin(started), agreed=True)
    wanted = min(costs.rooms, key=lambda room: costs.rows[0][room.people])
    facts = where_facts(state, (), 0, (), tick=50, rival=wanted)
    tours = searched_tours(costs, [TourStart(costs.rows[0], energy)] * 2, costs.rooms, VISIT, sent=0)
    assert facts.tour == tours[0].rooms
    assert set(facts.values) == {room for room in costs.rooms if costs.rows[0][room.people] <= energy}
    assert max(value.rooms for value in facts.values.values()) <= sum(len(tour.rooms) for tour in tours)
    for advised in (tours[0].rooms[0], wanted, max(facts.values)):
        told = replace(facts, advised=advised)
        evidence = where(told, rival=wanted)
        assert evidence.decision == Literal(NextRoom(0, advised))
        said = {
            literal.proposition
            for enquiry in questions(told, evidence, Literal(NextRoom(0, wanted)))
            for literal in explain(enquiry, told, evidence).because
        }
        begun = tours_begun_with(costs, [TourStart(costs.rows[0], energy)] * 2, tours, 0, advised, VISIT)
        spent = sum(cost_of(state, 0, tuple(room.people for room in tour.rooms)) for tour in begun)
        (plan,) = (each for each in said if isinstance(each, TeamPlan))
        assert (plan.room, plan.rooms) == (advised, sum(len(tour.rooms) for tour in begun))
        assert plan.energy == pytest.approx(spent)
        assert not any(isinstance(each, FewerRooms | DearerPlan | ShorterPlan | LeftBehind) for each in said)
        for each in said:
            assert not isinstance(each, EnergyCost) or each.energy == costs.rows[0][each.goal.people]


@settings(max_examples=25)
@given(states(), st.integers(0, 1))
def test_what_would_change_its_mind_does(state: GameState, robot: int) -> None:
    facts = where_facts(state, (), robot, (), tick=50)
    evidence = where(facts)
    assume(evidence.decision is not None)
    for enquiry in questions(facts, evidence, Literal(NextRoom(robot, min(facts.values, default=Room(1))))):
        if enquiry.question is not Question.CHANGE:
            continue
        for literal in explain(enquiry, facts, evidence).because:
            if isinstance(literal.proposition, CostsMore):
                room = literal.proposition.goal
                dearer = literal.proposition.energy - facts.costs[room] + 1e-6
                value = facts.values[room]
                values = {**facts.values, room: PlanValue(value.rooms, value.cost + dearer)}
                assert where(replace(facts, values=values, advised=None)).decision != evidence.decision


kinds = st.builds(
    lambda colour, footprint, name, points: TreasureKind(
        {"colour": colour, "footprint": footprint}, points, name, None
    ),
    st.sampled_from(["red", "blue"]),
    st.sampled_from(["round", "square"]),
    st.sampled_from(["cup", "hat", "key"]),
    st.integers(1, 50),
)


@given(states(), st.lists(kinds, min_size=ROOMS, max_size=ROOMS), st.lists(kinds, min_size=ROOMS, max_size=ROOMS))
def test_what_is_hidden_changes_nothing_that_a_robot_knows(
    state: GameState, one: list[TreasureKind], other: list[TreasureKind]
) -> None:
    first, second = structs.replace(state, treasures=tuple(one)), structs.replace(state, treasures=tuple(other))
    listed = (*one, *other)
    for robot in (0, 1):
        assert where_facts(first, (), robot, (), 50) == where_facts(second, (), robot, (), 50)
        for room in state.started.costs.rooms:
            known: list[WhatFacts] = [what_facts(each, robot, room, listed, 50) for each in (first, second)]
            assert known[0] == known[1]
            assert what(known[0]) == what(known[1])


@given(states())
def test_a_room_that_another_robot_is_about_to_go_to_is_known_as_such(state: GameState) -> None:
    facts: WhereFacts = where_facts(state, (Discussed(1, "select-room", 2),), 0, (), 50)
    assert facts.under_way == {Room(2): 1}
    assert Room(2) not in facts.values


@given(states(), st.integers(0, 1))
def test_an_adviser_that_may_err_compares_nothing_in_any_answer(state: GameState, robot: int) -> None:
    facts = replace(where_facts(state, (), robot, (), tick=50), compares=False)
    evidence = where(facts)
    for enquiry in questions(facts, evidence, Literal(NextRoom(robot, min(facts.values, default=Room(1))))):
        said = [literal.proposition for literal in explain(enquiry, facts, evidence).because]
        assert not any(isinstance(each, TeamPlan | CostOfOther | FewerRooms | DearerPlan) for each in said)
