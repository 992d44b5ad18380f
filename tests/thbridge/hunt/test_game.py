"""Rules and fold together: examples of every rule, and what holds whatever people ask for."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.hunts.game_states import (
    ARENA,
    ORANGE,
    ROOM_1,
    ROOM_2,
    ROOM_4,
    after,
    fold,
    in_room_4,
    new_game,
    small_game,
    visit,
)
from thbridge.hunt import rules
from thbridge.hunt.codec import from_json, to_json
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import (
    Condition,
    ConditionChanged,
    EndReason,
    GameEnded,
    MoveFailed,
    RobotArrived,
    RobotDeparted,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
    TreasureSensed,
    TreasuresHidden,
    TreasureTakenUp,
)
from thbridge.hunt.game import apply, begin
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.hunt.rules import RuleReason

# --- moves

PRICED = (None, 9.0, 8.0, 7.0, 6.0, 5.0, None, 3.0, 2.0)
"""Energy from some place outside the rooms; there is no way to room 6."""


def test_a_robot_priced_where_it_stands_pays_that_and_in_a_room_what_the_matrix_says():
    state = after(new_game(), rules.price(new_game(), 0, PRICED))
    assert state.by_position
    assert state.cost(0, ROOM_4) == 6.0
    assert state.cost(1, ROOM_4) == 13.0, "of the others nothing is known yet"
    assert rules.move(state, 0, ROOM_4) == (RobotDeparted(0, ROOM_4, 6.0),)
    assert rules.move(state, 0, Room(6)).reason is RuleReason.NOT_A_MOVE
    assert rules.affordable(state, 0) == tuple(room for room in ARENA.rooms if room != Room(6))
    state = visit(state, 0, ROOM_4)
    assert state.cost(0, ROOM_1) == ARENA.cost(ROOM_4, ROOM_1)


def test_a_robot_under_way_keeps_the_price_of_its_departure_and_is_priced_anew_where_it_stops():
    state = after(new_game(), rules.price(new_game(), 0, PRICED))
    state = after(state, rules.move(state, 0, ROOM_4))
    assert rules.price(state, 0, PRICED).reason is RuleReason.UNDER_WAY
    state = after(state, rules.fail(state, 0, "A door is shut.", 0.5, CORRIDOR))
    assert state.robots[0].energy == 97.0
    state = after(state, rules.price(state, 0, (None, *(4.0 for _ in ARENA.rooms))))
    assert state.costs_from(0)[1:] == (4.0,) * 8


def test_prices_that_are_known_are_no_event():
    state = after(new_game(), rules.price(new_game(), 0, PRICED))
    assert rules.price(state, 0, PRICED) == ()
    state = visit(state, 0, ROOM_4)
    row = [None if cost == float("inf") else cost for cost in ARENA.rows[4]]
    # The room's own entry means nothing there: a robot is not sent to where it stands.
    assert rules.price(state, 0, (*row[:4], 2.0, *row[5:])) == ()


@pytest.mark.parametrize(
    "costs", [PRICED[:-1], (*PRICED, 1.0), (None, -1.0, *PRICED[2:]), (None, float("nan"), *PRICED[2:])]
)
def test_prices_that_fit_no_game_are_refused(costs):
    assert isinstance(rules.price(new_game(), 0, costs), RequestRefused)
    assert isinstance(rules.price(new_game(), 5, PRICED), RequestRefused)


def test_a_move_costs_the_matrix_entry_at_departure_and_reserves_the_room():
    state = new_game()
    ruling = rules.move(state, 0, ROOM_4)
    assert ruling == (RobotDeparted(0, ROOM_4, 13.0),)
    state = after(state, ruling)
    assert state.robots[0].energy == 87.0
    assert state.reserved_by(ROOM_4) == 0
    assert not state.room(ROOM_4).visited


def test_the_cost_is_counted_from_the_room_the_robot_stands_in():
    state = visit(new_game(), 0, ROOM_1)
    assert rules.move(state, 0, ROOM_4) == (RobotDeparted(0, ROOM_4, 10.0),)


def test_arriving_visits_the_room_and_frees_the_robot():
    state = visit(new_game(), 0, ROOM_4)
    assert state.room(ROOM_4).visited
    assert (state.robots[0].at, state.robots[0].bound_for) == (ROOM_4, None)
    assert state.standing_in(ROOM_4) == 0
    assert ROOM_4 not in state.free_rooms


def refusals():
    fresh = new_game()
    under_way = after(fresh, rules.move(fresh, 0, ROOM_4))
    visited = visit(fresh, 0, ROOM_4)
    poor = new_game(energy=12.0)
    walled = new_game(costs=CostMatrix.of_map_times(((99.0, 5.0, 99.0), (99.0,) * 3, (99.0,) * 3)))
    silent = apply(fresh, ConditionChanged(0, Condition.SILENT))
    exhausted = visit(new_game(energy=13.0), 0, ROOM_4)
    over = apply(fresh, GameEnded(EndReason.ALL_VISITED, 0))
    return [
        (fresh, 2, ROOM_1, RuleReason.UNKNOWN_ROBOT, ["robot 3"]),
        (fresh, -1, ROOM_1, RuleReason.UNKNOWN_ROBOT, []),
        (fresh, 0, Room(9), RuleReason.UNKNOWN_ROOM, ["Room 9", "8"]),
        (fresh, 0, CORRIDOR, RuleReason.UNKNOWN_ROOM, ["corridor"]),
        (under_way, 0, ROOM_1, RuleReason.UNDER_WAY, ["Robot 1", "room 4"]),
        (under_way, 1, ROOM_4, RuleReason.RESERVED, ["Robot 1", "room 4"]),
        (visited, 1, ROOM_4, RuleReason.ALREADY_VISITED, ["Room 4"]),
        (poor, 0, ROOM_4, RuleReason.NOT_ENOUGH_ENERGY, ["Robot 1", "12", "13"]),
        (walled, 0, ROOM_2, RuleReason.NOT_A_MOVE, ["the corridor", "room 2"]),
        (exhausted, 0, ROOM_1, RuleReason.BLOCKED, ["Robot 1"]),
        (silent, 0, ROOM_1, RuleReason.SILENT, ["Robot 1 no longer answers"]),
        (over, 0, ROOM_1, RuleReason.GAME_OVER, ["over"]),
    ]


@pytest.mark.parametrize(("state", "robot", "room", "reason", "named"), refusals())
def test_a_move_is_refused_with_its_reason(state, robot, room, reason, named):
    refused = rules.move(state, robot, room)
    assert isinstance(refused, RequestRefused)
    assert refused.reason == reason
    assert all(word in refused.sentence for word in named), refused.sentence
    assert refused.sentence.endswith(".")


def test_all_energy_may_be_spent_on_a_move():
    state = new_game(energy=13.0)
    assert visit(state, 0, ROOM_4).robots[0].is_blocked


# --- failures


def test_the_reason_of_a_failure_stays_until_the_next_move_has_ended():
    state = new_game()
    state = after(state, rules.move(state, 0, ROOM_4))
    state = after(state, rules.fail(state, 0, "It is stuck.", 0.25))
    assert state.robots[0].failure == "It is stuck."
    state = after(state, rules.move(state, 0, ROOM_4))
    assert after(state, rules.arrive(state, 0, ROOM_4)).robots[0].failure == ""


def test_a_failure_gives_back_the_unspent_share_and_frees_the_room():
    state = new_game()
    state = after(state, rules.move(state, 0, ROOM_4))
    state = after(state, rules.fail(state, 0, "no path", 0.25))
    assert state.robots[0].energy == 100.0 - 0.25 * 13.0
    assert state.reserved_by(ROOM_4) is None
    assert ROOM_4 in state.free_rooms
    assert state.robots[0].at == CORRIDOR


@pytest.mark.parametrize(
    ("share", "at", "stands"),
    [
        (0.0, None, ROOM_1),
        (0.5, None, CORRIDOR),
        (0.1, ROOM_1, ROOM_1),
        (0.9, ROOM_4, CORRIDOR),
        (0.9, Room(20), CORRIDOR),
    ],
)
def test_a_failed_robot_stands_where_its_next_move_can_begin(share, at, stands):
    state = visit(new_game(), 0, ROOM_1)
    state = after(state, rules.move(state, 0, ROOM_4))
    state = after(state, rules.fail(state, 0, "cancelled", share, at))
    assert state.robots[0].at == stands
    assert not isinstance(rules.move(state, 0, ROOM_4), RequestRefused)


@pytest.mark.parametrize(("share", "energy"), [(-3.0, 100.0), (7.0, 87.0)])
def test_no_more_and_no_less_than_the_way_is_refunded(share, energy):
    state = new_game()
    state = after(state, rules.move(state, 0, ROOM_4))
    assert after(state, rules.fail(state, 0, "stuck", share)).robots[0].energy == energy


def test_only_a_robot_under_way_can_fail():
    assert rules.fail(new_game(), 0, "bored", 0.0).reason == RuleReason.NOT_UNDER_WAY
    assert rules.fail(new_game(), 5, "bored", 0.0).reason == RuleReason.UNKNOWN_ROBOT


# --- treasures


def test_sensing_tells_colour_and_footprint_once():
    state = visit(new_game(), 0, ROOM_4)
    ruling = rules.sense(state, ROOM_4)
    assert ruling == (TreasureSensed(ROOM_4, {"colour": "Orange", "footprint": "Round and Large"}),)
    assert rules.sense(after(state, ruling), ROOM_4) == ()


def test_a_picture_costs_energy_once():
    state = in_room_4()
    first = rules.picture(state, ROOM_4)
    assert first == (TreasurePictured(ROOM_4, 0, "rsz_t1.jpg", 5.0),)
    state = after(state, first)
    assert state.robots[0].energy == 100.0 - 13.0 - 5.0
    assert rules.picture(state, ROOM_4) == (TreasurePictured(ROOM_4, 0, "rsz_t1.jpg", 0.0),)


@pytest.mark.parametrize("rule", [rules.picture, rules.sense, lambda state, room: rules.identify(state, room, "x")])
def test_a_treasure_is_dealt_with_only_where_a_robot_stands(rule):
    state = in_room_4()
    assert rule(state, ROOM_1).reason == RuleReason.NOBODY_THERE
    assert rule(state, Room(9)).reason == RuleReason.UNKNOWN_ROOM
    gone = after(state, rules.move(state, 0, ROOM_1))
    assert rule(gone, ROOM_4).reason == RuleReason.NOBODY_THERE


def test_the_right_name_wins_the_points_and_costs_energy():
    state = in_room_4()
    state = after(state, rules.identify(state, ROOM_4, "orange bottle"))
    assert state.score == 10
    assert state.room(ROOM_4).points == 10
    assert state.robots[0].energy == 100.0 - 13.0 - 2.0


@pytest.mark.parametrize(("share", "lost"), [(1.0, 10), (0.5, 5), (0.25, 3), (0.0, 0)])
def test_a_wrong_name_costs_its_share_of_the_points(share, lost):
    state = in_room_4(wrong_share=share)
    assert after(state, rules.identify(state, ROOM_4, "Pink can")).score == -lost


def test_a_treasure_is_decided_once():
    state = in_room_4()
    named = after(state, rules.identify(state, ROOM_4, "Pink can"))
    given_up = after(state, rules.leave(state, ROOM_4))
    for decided in (named, given_up):
        assert rules.identify(decided, ROOM_4, "Orange Bottle").reason == RuleReason.ALREADY_DECIDED
    assert rules.leave(named, ROOM_4).reason == RuleReason.ALREADY_DECIDED
    assert rules.leave(given_up, ROOM_4) == (), "what was given up is given up once, however often it is requested"


def test_energy_that_does_not_suffice_is_named_with_what_is_needed():
    state = in_room_4(energy=14.0)
    for ruling, cost in ((rules.picture(state, ROOM_4), "5"), (rules.identify(state, ROOM_4, "x"), "2")):
        assert ruling.reason == RuleReason.NOT_ENOUGH_ENERGY
        assert "1 energy" in ruling.sentence and cost in ruling.sentence


def test_a_blocked_robot_neither_pictures_nor_identifies():
    state = in_room_4(energy=13.0, picture_cost=0.0, identify_cost=0.0)
    assert rules.picture(state, ROOM_4).reason == RuleReason.BLOCKED
    assert rules.identify(state, ROOM_4, "Orange Bottle").reason == RuleReason.BLOCKED


def test_going_on_leaves_an_undecided_treasure():
    state = in_room_4()
    assert rules.move(state, 0, ROOM_1) == (TreasureLeft(ROOM_4), RobotDeparted(0, ROOM_1, 18.0))
    decided = after(state, rules.identify(state, ROOM_4, "x"))
    assert rules.move(decided, 0, ROOM_1) == (RobotDeparted(0, ROOM_1, 18.0),)


def test_what_was_left_is_taken_up_again_until_its_robot_sets_out():
    state = in_room_4()
    assert rules.take_up(state, ROOM_4) == (), "it was not left"
    left = after(state, rules.leave(state, ROOM_4))
    assert rules.take_up(left, ROOM_4) == (TreasureTakenUp(ROOM_4),)
    again = after(left, rules.take_up(left, ROOM_4))
    assert again == state
    named = after(again, rules.identify(again, ROOM_4, "Orange Bottle"))
    assert rules.take_up(named, ROOM_4).reason == RuleReason.ALREADY_DECIDED
    away = after(left, rules.move(left, 0, ROOM_1))
    assert rules.take_up(away, ROOM_4).reason == RuleReason.NOBODY_THERE
    back = after(away, rules.fail(away, 0, "called back", 0.0))
    assert rules.take_up(back, ROOM_4) == (TreasureTakenUp(ROOM_4),), "it had not left the room yet"
    over = after(left, rules.end_game(left))
    assert rules.take_up(over, ROOM_4).reason == RuleReason.GAME_OVER
    assert rules.take_up(left, Room(9)).reason == RuleReason.UNKNOWN_ROOM


def test_the_game_waits_again_for_what_was_taken_up():
    state = visit(small_game(energy=9.0, identify_cost=4.0), 0, ROOM_1)
    left = after(state, rules.leave(state, ROOM_1))
    assert rules.ending(state) == () and rules.ending(left) != ()
    assert rules.ending(after(left, rules.take_up(left, ROOM_1))) == ()


def test_nothing_can_be_left_where_nobody_has_been():
    assert rules.leave(new_game(), ROOM_1).reason == RuleReason.NOBODY_THERE


# --- what other programs tell


def test_another_programs_hider_may_tell_what_this_game_did_not_hide():
    state = begin(new_game().started)
    state = visit(state, 0, ROOM_4)
    assert rules.sense(state, ROOM_4).reason == RuleReason.NOTHING_KNOWN
    assert rules.picture(state, ROOM_4).reason == RuleReason.NOTHING_KNOWN
    assert rules.identify(state, ROOM_4, "x").reason == RuleReason.NOTHING_KNOWN
    state = after(state, rules.sense(state, ROOM_4, {"colour": "Blue", "footprint": "Round"}))
    state = after(state, rules.picture(state, ROOM_4, "rsz_t2.jpg"))
    state = after(state, rules.identify(state, ROOM_4, "Blue Bottle", 20))
    assert state.score == 20
    assert state.room(ROOM_4).sensed == {"colour": "Blue", "footprint": "Round"}


def test_a_score_alone_counts():
    state = apply(new_game(), TreasureIdentified(None, None, None, -20, 0.0))
    assert state.score == -20
    assert (
        apply(apply(state, GameEnded(EndReason.ALL_VISITED, -20)), TreasureIdentified(None, None, None, 30, 0.0)).score
        == 10
    )


def test_an_arrival_nobody_announced_moves_the_robot():
    state = apply(new_game(), RobotArrived(0, ROOM_4))
    assert (state.robots[0].at, state.robots[0].energy) == (ROOM_4, 100.0)
    assert state.room(ROOM_4).visited


def test_the_rule_of_arrival_puts_the_missing_departure_in():
    poor = new_game(energy=3.0)
    ruling = rules.arrive(poor, 0, ROOM_4)
    assert ruling == (RobotDeparted(0, ROOM_4, 13.0), RobotArrived(0, ROOM_4))
    assert after(poor, ruling).robots[0].is_blocked


def test_arriving_elsewhere_gives_the_first_way_up():
    state = new_game()
    state = after(state, rules.move(state, 0, ROOM_4))
    state = after(state, rules.arrive(state, 0, ROOM_1))
    assert state.robots[0].at == ROOM_1
    assert state.reserved_by(ROOM_4) is None
    assert ROOM_4 in state.free_rooms


def test_a_failure_nobody_announced_refunds_nothing():
    state = apply(new_game(), MoveFailed(0, ROOM_4, "?", 50.0, CORRIDOR))
    assert state.robots[0].energy == 100.0


@pytest.mark.parametrize(
    "event",
    [
        RobotDeparted(2, ROOM_1, 1.0),
        RobotDeparted(0, Room(9), 1.0),
        RobotArrived(-1, ROOM_1),
        RobotArrived(0, CORRIDOR),
        TreasurePictured(ROOM_1, 5, "x", 1.0),
        TreasuresHidden((ORANGE,)),
    ],
)
def test_events_of_another_game_are_refused(event):
    with pytest.raises(ValueError):
        apply(new_game(), event)


# --- the end


def test_the_game_ends_when_every_room_is_visited_and_decided():
    state = visit(small_game(), 0, ROOM_1)
    assert rules.ending(state) == ()
    state = after(state, rules.move(state, 0, ROOM_2))
    assert rules.ending(state) == ()
    state = after(state, rules.arrive(state, 0, ROOM_2))
    assert rules.ending(state) == (), "the treasure there is about to be sensed"
    state = after(state, rules.sense(state, ROOM_2))
    assert rules.ending(state) == ()
    assert rules.ending(state, wait_for_decisions=False) == (GameEnded(EndReason.ALL_VISITED, 0),)
    state = after(state, rules.identify(state, ROOM_2, "Orange Bottle"))
    assert rules.ending(state) == (GameEnded(EndReason.ALL_VISITED, 10),)
    assert rules.ending(after(state, rules.ending(state))) == (), "a game ends once"


def test_the_game_ends_when_no_robot_can_pay_another_move():
    state = small_game(energy=4.0)
    assert rules.ending(state) == (GameEnded(EndReason.NO_MOVE_LEFT, 0),)
    state = visit(small_game(energy=9.0, identify_cost=4.0), 0, ROOM_1)
    assert rules.ending(state) == (), "the treasure can still be identified"
    assert rules.ending(after(state, rules.leave(state, ROOM_1))) == (GameEnded(EndReason.NO_MOVE_LEFT, 0),)


def test_a_treasure_that_nobody_can_pay_to_identify_does_not_hold_the_game_up():
    state = visit(small_game(energy=6.0), 0, ROOM_1)
    assert rules.ending(state) == (GameEnded(EndReason.NO_MOVE_LEFT, 0),)


def test_another_robot_that_can_still_move_keeps_the_game_going():
    state = new_game(robots=2, energy=13.0)
    state = visit(state, 0, ROOM_4)
    assert rules.ending(state) == ()
    assert rules.affordable(state, 0) == () and rules.affordable(state, 1)


def test_a_game_is_given_up_only_when_nobody_is_under_way():
    state = new_game()
    assert rules.end_game(state) == (GameEnded(EndReason.GIVEN_UP, 0),)
    moving = after(state, rules.move(state, 1, ROOM_1))
    assert rules.end_game(moving).reason is RuleReason.UNDER_WAY
    assert rules.end_game(after(state, rules.end_game(state))).reason is RuleReason.GAME_OVER


# --- how robots are


def test_a_robot_that_does_not_answer_does_nothing_and_what_is_there_is_left_to_nobody_else():
    state = after(in_room_4(), rules.report(in_room_4(), 0, Condition.SILENT))
    for refused in (rules.move(state, 0, ROOM_1), rules.picture(state, ROOM_4), rules.identify(state, ROOM_4, "x")):
        assert (refused.reason, refused.sentence) == (RuleReason.SILENT, "Robot 1 no longer answers.")
    assert rules.affordable(state, 0) == ()
    assert rules.affordable(state, 1)
    answering = after(state, rules.report(state, 0, Condition.WELL))
    assert answering == in_room_4()


def test_the_game_ends_when_no_robot_that_answers_can_do_anything_more():
    state = in_room_4(energy=13.0, identify_cost=0.0)
    state = after(state, rules.report(state, 1, Condition.SILENT))
    state = after(state, rules.report(state, 0, Condition.SILENT))
    assert rules.ending(state) == (GameEnded(EndReason.NO_MOVE_LEFT, 0),), "no treasure is decided by a silent robot"
    assert rules.ending(after(state, rules.report(state, 1, Condition.WELL))) == ()


def test_a_robot_that_is_lost_may_be_sent():
    state = after(new_game(), rules.report(new_game(), 0, Condition.LOST))
    assert rules.move(state, 0, ROOM_1) == rules.move(new_game(), 0, ROOM_1)


def test_a_condition_told_again_is_no_event():
    state = new_game()
    assert rules.report(state, 0, Condition.WELL) == ()
    assert rules.report(state, 5, Condition.LOST).reason is RuleReason.UNKNOWN_ROBOT


# --- whatever people ask for

RULES = (
    st.tuples(st.just(rules.move), st.integers(-1, 3), st.integers(0, 9).map(Room)),
    st.tuples(st.just(rules.fail), st.integers(-1, 3), st.just("stuck"), st.floats(0, 1)),
    st.tuples(st.just(rules.sense), st.integers(0, 9).map(Room)),
    st.tuples(st.just(rules.picture), st.integers(0, 9).map(Room)),
    st.tuples(st.just(rules.identify), st.integers(0, 9).map(Room), st.sampled_from(["Pink can", "Orange Bottle"])),
    st.tuples(st.just(rules.leave), st.integers(0, 9).map(Room)),
    st.tuples(st.just(rules.take_up), st.integers(0, 9).map(Room)),
    st.tuples(st.just(rules.report), st.integers(-1, 3), st.sampled_from(Condition)),
)
ARRIVALS = st.tuples(st.just("arrive"), st.integers(0, 2))


@given(requests=st.lists(st.one_of(*RULES, ARRIVALS), max_size=60), energy=st.sampled_from([30.0, 60.0, 100.0]))
def test_whatever_is_asked_the_game_keeps_its_promises(requests, energy):
    live = new_game(robots=3, energy=energy)
    said = [TreasuresHidden(live.treasures)]
    for rule, *request in requests:
        if rule == "arrive":
            (robot,) = request
            bound_for = live.robots[robot].bound_for
            ruling = () if bound_for is None else rules.arrive(live, robot, bound_for)
        else:
            ruling = rule(live, *request)
        if isinstance(ruling, RequestRefused):
            continue
        was_over = live.ended is not None
        for event in ruling:
            assert not was_over or isinstance(event, MoveFailed), "an ended game accepts nothing"
            live = apply(live, event)
            said.append(event)
        for event in rules.ending(live):
            live = apply(live, event)
            said.append(event)

    assert all(robot.energy >= 0.0 for robot in live.robots)
    assert live.score == sum(event.points for event in said if isinstance(event, TreasureIdentified))
    for room in ARENA.rooms:
        departed = sum(isinstance(event, RobotDeparted) and event.room == room for event in said)
        failed = sum(isinstance(event, MoveFailed) and event.room == room for event in said)
        assert departed - failed <= 1
    assert fold(live.started, [from_json(to_json(event)) for event in said]) == live
    if live.ended is not None:
        assert all(
            isinstance(rules.move(live, robot, room), RequestRefused) for robot in range(3) for room in ARENA.rooms
        )
