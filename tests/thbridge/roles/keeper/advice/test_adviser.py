"""What robots advise in a team: each takes its first room of the joint plan, and says why."""

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from msgspec.structs import replace

from tests.support.hunts.game_states import ARENA, after, new_game, visit
from tests.support.hunts.random_hunts import random_hunt
from thbridge.hunt import rules
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import Commander, Condition
from thbridge.hunt.game import CommandHolder
from thbridge.hunt.planners import searched_tours
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.hunt.tour import NoTour, best_tour
from thbridge.roles.keeper.advice.adviser import Adviser
from thbridge.roles.shared.participant_rules import Discussed

ADVISER = Adviser()
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


def said(advice):
    """Room and reason of advice that does not err."""
    assert (advice.planned, advice.erred, advice.confidence) == (advice.room, False, None)
    return advice.room, advice.reason


def test_robots_that_start_together_are_sent_to_different_ends():
    state = new_game(costs=TWO_ENDS)
    first = ADVISER.advise(state, (), 0)
    assert said(first) == (Room(1), "no other room costs me less")
    state = after(state, rules.move(state, 0, Room(1)))
    second = ADVISER.advise(state, (), 1)
    assert said(second) == (Room(3), "room 2 costs me less, but robot 1 is better placed for it")


def test_a_robot_that_is_being_talked_with_counts_as_sent():
    state = new_game(costs=TWO_ENDS)
    talk = (Discussed(0, "select-room", 1),)
    second = ADVISER.advise(state, talk, 1)
    assert said(second) == (Room(3), "room 2 costs me less, but robot 1 is better placed for it")


@pytest.mark.parametrize("why", ["silent", "commanded"])
def test_a_robot_that_cannot_be_sent_is_not_counted_on(why):
    state = new_game(costs=TWO_ENDS)
    state = visit(state, 0, Room(1))
    if why == "silent":
        state = after(state, rules.report(state, 0, Condition.SILENT))
    else:
        state = after(state, rules.command(state, 0, CommandHolder(Commander.GROUND_STATION, "QGroundControl")))
    alone = ADVISER.advise(state, (), 1)
    assert alone.room == best_tour(TWO_ENDS, CORRIDOR, state.free_rooms, 100.0, 2.0).rooms[0]
    assert "robot 1" not in alone.reason


def test_energy_for_naming_what_a_robot_will_find_is_kept():
    # Robot 1 under way to room 1 has 16 - 9 = 7 left: enough for room 2 (5), not after naming what it finds (3).
    state = new_game(costs=TWO_ENDS, energy=16.0, identify_cost=3.0)
    state = after(state, rules.move(state, 0, Room(1)))
    assert ADVISER.advise(state, (), 1).room == Room(2)
    rich = new_game(costs=TWO_ENDS, energy=17.0, identify_cost=3.0)
    assert ADVISER.advise(after(rich, rules.move(rich, 0, Room(1))), (), 1).room == Room(3)


def test_nothing_to_advise_is_refused_as_for_one_robot():
    state = new_game(energy=12.0)
    assert ADVISER.advise(state, (), 0).reason == NoTour.NOT_ENOUGH_ENERGY


def at_two_ends(rooms):
    """Costs of a corridor in the middle, half the rooms in a row to its left and half to its right, a bit nearer."""
    half = rooms // 2
    places = [0.0, *(-11.0 - place for place in range(half)), *(9.0 + place for place in range(half))]
    return CostMatrix(tuple(tuple(abs(one - other) or 99.0 for other in places) for one in places))


@pytest.mark.parametrize("rooms", [16, 18, 24, 40])
def test_a_team_shares_out_any_number_of_rooms(rooms):
    state = new_game(costs=at_two_ends(rooms))
    nearest = Room(rooms // 2 + 1)
    state = after(state, rules.move(state, 0, nearest))
    reason = f"{Room(nearest.people + 1)} costs me less, but robot 1 is better placed for it"
    assert said(ADVISER.advise(state, (), 1)) == (Room(1), reason)


@pytest.mark.parametrize(("planner", "robots"), [("joint", 3), ("tour", 1)])
def test_of_a_plan_that_was_searched_for_nothing_is_claimed_that_only_the_best_could_keep(planner, robots):
    seen = set()
    for seed in range(6):
        costs, starts = random_hunt(20, robots, 60.0, seed)
        state = new_game(costs=costs, robots=robots, energy=60.0)
        placed = [replace(one, costs=start.costs) for one, start in zip(state.robots, starts, strict=True)]
        state = replace(state, robots=tuple(placed))
        advice = Adviser(TeamPlanner(planner)).advise(state, (), 0)
        assert advice.room == searched_tours(costs, starts, state.free_rooms, 2.0, sent=0)[0].rooms[0]
        assert "round" not in advice.reason and "reach" not in advice.reason
        seen.add(advice.reason.partition(" ")[0])
    assert "it" in seen


@settings(deadline=None, max_examples=60)
@given(
    energies=st.lists(st.floats(0.0, 120.0), min_size=1, max_size=4),
    places=st.permutations(range(1, 9)),
    adviser=st.integers(0, 3),
    planner=st.sampled_from(TeamPlanner),
    error_rate=st.sampled_from([0.0, 0.5, 1.0]),
)
def test_advice_is_always_a_room_that_the_robot_may_be_sent_to(energies, places, adviser, planner, error_rate):
    state = new_game(robots=len(energies))
    for robot in range(len(energies)):
        state = visit(state, robot, Room(places[robot]))
    robots = tuple(replace(one, energy=energy) for one, energy in zip(state.robots, energies, strict=True))
    state = replace(state, robots=robots)
    adviser %= len(energies)
    advice = Adviser(planner, error_rate).advise(state, (), adviser)
    own = best_tour(ARENA, state.robots[adviser].at, state.free_rooms, energies[adviser], 2.0)
    if isinstance(advice, RequestRefused):
        assert advice == own
    else:
        assert isinstance(rules.move(state, adviser, advice.room), tuple)
        assert isinstance(rules.move(state, adviser, advice.planned), tuple)
        assert advice.erred == (advice.room != advice.planned)
        assert advice.reason and not isinstance(own, RequestRefused)


# Robot 1 stands where room 1 costs 5 and room 2 costs 6; robot 2 has been sent to room 3, right beside room 1.
# Nobody can pay for room 4.
NO = 1e3
BESIDE = CostMatrix(
    (
        (NO, 5.0, 6.0, 9.0, NO),
        (NO, NO, 20.0, 20.0, NO),
        (NO, 12.0, NO, 20.0, NO),
        (NO, 1.0, 20.0, NO, NO),
        (NO, NO, NO, NO, NO),
    )
)


@pytest.mark.parametrize(
    ("planner", "room", "reason"),
    [
        ("joint", 2, "room 1 costs me less, but robot 2 is better placed for it"),
        ("auction", 2, "room 1 costs me less, but robot 2 is better placed for it"),
        ("greedy", 2, "room 1 costs me less, but robot 2 is better placed for it"),
        ("nearest", 1, "no other room costs me less"),
        ("tour", 2, "room 1 costs me less now, but my whole round costs less with room 2 first"),
    ],
)
def test_robots_advise_by_the_planner_of_the_study_and_with_its_reason(planner, room, reason):
    state = new_game(costs=BESIDE)
    state = after(state, rules.move(state, 1, Room(3)))
    assert said(Adviser(TeamPlanner(planner)).advise(state, (), 0)) == (Room(room), reason)


def test_nothing_is_claimed_of_a_whole_round_that_may_not_be_the_best():
    seen = set()
    for seed in range(300):
        costs, starts = random_hunt(6, 1, 1e3, seed)
        whole = CostMatrix((starts[0].costs, *costs.rows[1:]))
        advice = Adviser(TeamPlanner.AUCTION).advise(new_game(costs=whole, robots=1, energy=1e3), (), 0)
        seen.add(advice.reason.partition(" ")[0])
        assert "round" not in advice.reason and "reach" not in advice.reason
    assert seen == {"no", "it"}


def test_an_adviser_that_errs_names_another_room_and_its_true_cost():
    state, adviser = new_game(costs=TWO_ENDS), Adviser(error_rate=1.0)
    given = [adviser.advise(state, (), 0, number) for number in range(1, 60)]
    assert {advice.room for advice in given} == {Room(2), Room(3), Room(4)}
    assert {advice.planned for advice in given} == {Room(1)}
    assert {(advice.room, advice.reason) for advice in given} == {
        (Room(2), "it costs me 10"),
        (Room(3), "it costs me 11"),
        (Room(4), "it costs me 12"),
    }
    assert all(advice.erred for advice in given)


def test_an_adviser_errs_as_often_as_it_shall_and_right_advice_sounds_no_other_way():
    state, adviser = new_game(costs=TWO_ENDS), Adviser(error_rate=0.3)
    given = [adviser.advise(state, (), 0, number) for number in range(2000)]
    assert sum(advice.erred for advice in given) == pytest.approx(600, abs=70)
    assert {advice.reason for advice in given if not advice.erred} == {"it costs me 9"}


def test_errors_follow_from_seed_game_robot_and_number_alone():
    adviser = Adviser(error_rate=0.5)

    def errors(robot=0, **changes):
        state = new_game(costs=TWO_ENDS)
        state = replace(state, started=replace(state.started, **changes))
        return [adviser.advise(state, (), robot, number).room for number in range(40)]

    assert errors() == errors()
    others = [errors(robot=1), errors(seed=2), errors(game=2)]
    assert all(errors() != other for other in others)


@pytest.mark.parametrize(("rate", "spread"), [(0.3, 0.3), (0.5, 0.5), (0.8, 0.1)])
def test_confidence_that_differs_from_advice_to_advice_is_the_share_of_those_that_are_right(rate, spread):
    state, bins = new_game(costs=TWO_ENDS), 4
    adviser = Adviser(error_rate=rate, says_confidence=True, confidence_spread=spread)
    given = [adviser.advise(state, (), 0, number) for number in range(6000)]
    assert sum(advice.erred for advice in given) == pytest.approx(6000 * rate, abs=150)
    least = 1.0 - rate - spread
    edges = [least + place * 2.0 * spread / bins for place in range(bins + 1)]
    for low, high in itertools.pairwise(edges):
        alike = [advice for advice in given if low <= advice.confidence < high]
        assert len(alike) == pytest.approx(6000 / bins, abs=150), "each confidence is as likely"
        right = sum(not advice.erred for advice in alike) / len(alike)
        assert right == pytest.approx(sum(advice.confidence for advice in alike) / len(alike), abs=0.05)


def test_with_one_room_left_there_is_no_way_to_err():
    state = new_game(costs=TWO_ENDS, energy=9.5)
    only = Adviser(error_rate=1.0, says_confidence=True).advise(state, (), 0)
    assert (only.room, only.erred, only.confidence) == (Room(1), False, 1.0)


@pytest.mark.parametrize(
    ("rate", "bias", "stated"), [(0.0, 0.0, 1.0), (0.3, 0.0, 0.7), (0.3, 0.2, 0.9), (0.3, 0.5, 1.0), (0.9, -0.5, 0.0)]
)
def test_the_confidence_stated_is_the_share_of_right_advice_and_the_studys_bias(rate, bias, stated):
    state = new_game(costs=TWO_ENDS)
    for number in range(5):
        advice = Adviser(TeamPlanner.JOINT, rate, True, bias).advise(state, (), 0, number)
        assert advice.confidence == pytest.approx(stated)
