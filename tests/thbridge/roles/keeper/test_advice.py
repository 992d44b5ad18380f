"""What robots advise in a team: each takes its first room of the joint plan, and says why."""

from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.thbridge.hunt.test_game import ARENA, after, new_game, visit
from thbridge.hunt import rules
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import Commander, Condition
from thbridge.hunt.game import CommandHolder
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.hunt.tour import NoTour, best_tour
from thbridge.roles.keeper.advice import Advice, advise
from thbridge.roles.participant_rules import Discussed

FAR = 40.0
# Rooms 1 and 2 lie beside each other at one end, rooms 3 and 4 at the other; the corridor is nearer to the first.
TWO_ENDS = CostMatrix(
    (
        (99.0, 9.0, 10.0, 11.0, 12.0),
        (9.0, 99.0, 5.0, FAR, FAR),
        (10.0, 5.0, 99.0, FAR, FAR),
        (11.0, FAR, FAR, 99.0, 5.0),
        (12.0, FAR, FAR, 5.0, 99.0),
    )
)


def test_robots_that_start_together_are_sent_to_different_ends():
    state = new_game(costs=TWO_ENDS)
    first = advise(state, (), 0)
    assert first == Advice(Room(1), "no other room costs me less")
    state = after(state, rules.move(state, 0, Room(1)))
    second = advise(state, (), 1)
    assert second == Advice(Room(3), "room 2 costs me less, but robot 1 is better placed for it")


def test_a_robot_that_is_being_talked_with_counts_as_sent():
    state = new_game(costs=TWO_ENDS)
    talk = (Discussed(0, "select-room", 1),)
    assert advise(state, talk, 1) == Advice(Room(3), "room 2 costs me less, but robot 1 is better placed for it")


@pytest.mark.parametrize("why", ["silent", "commanded"])
def test_a_robot_that_cannot_be_sent_is_not_counted_on(why):
    state = new_game(costs=TWO_ENDS)
    state = visit(state, 0, Room(1))
    if why == "silent":
        state = after(state, rules.report(state, 0, Condition.SILENT))
    else:
        state = after(state, rules.command(state, 0, CommandHolder(Commander.GROUND_STATION, "QGroundControl")))
    alone = advise(state, (), 1)
    assert alone == Advice(best_tour(TWO_ENDS, CORRIDOR, state.free_rooms, 100.0, 2.0).rooms[0], alone.reason)
    assert "robot 1" not in alone.reason


def test_energy_for_naming_what_a_robot_will_find_is_kept():
    # Robot 1 under way to room 1 has 16 - 9 = 7 left: enough for room 2 (5), not after naming what it finds (3).
    state = new_game(costs=TWO_ENDS, energy=16.0, identify_cost=3.0)
    state = after(state, rules.move(state, 0, Room(1)))
    assert advise(state, (), 1).room == Room(2)
    rich = new_game(costs=TWO_ENDS, energy=17.0, identify_cost=3.0)
    assert advise(after(rich, rules.move(rich, 0, Room(1))), (), 1).room == Room(3)


def test_nothing_to_advise_is_refused_as_for_one_robot():
    state = new_game(energy=12.0)
    assert advise(state, (), 0).reason == NoTour.NOT_ENOUGH_ENERGY


def test_of_more_rooms_than_can_be_shared_out_a_robot_plans_its_own_tour():
    flat = CostMatrix(tuple(tuple(float(abs(a - b) or 99) for b in range(15)) for a in range(15)))
    assert advise(new_game(costs=flat), (), 1) == Advice(Room(1), "no other room costs me less")


@settings(deadline=None, max_examples=60)
@given(
    energies=st.lists(st.floats(0.0, 120.0), min_size=1, max_size=4),
    places=st.permutations(range(1, 9)),
    adviser=st.integers(0, 3),
)
def test_advice_is_always_a_room_that_the_robot_may_be_sent_to(energies, places, adviser):
    state = new_game(robots=len(energies))
    for robot in range(len(energies)):
        state = visit(state, robot, Room(places[robot]))
    robots = tuple(replace(one, energy=energy) for one, energy in zip(state.robots, energies, strict=True))
    state = replace(state, robots=robots)
    adviser %= len(energies)
    advice = advise(state, (), adviser)
    own = best_tour(ARENA, state.robots[adviser].at, state.free_rooms, energies[adviser], 2.0)
    if isinstance(advice, RequestRefused):
        assert advice == own
    else:
        assert isinstance(rules.move(state, adviser, advice.room), tuple)
        assert advice.reason and not isinstance(own, RequestRefused)
