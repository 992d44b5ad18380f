"""Who commands a robot: what is an event, who may move it, and to whom it goes back."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.hunts.game_states import ROOM_1, ROOM_2, ROOM_4, after, in_room_4, new_game, small_game, visit
from thbridge.hunt import rules
from thbridge.hunt.events import (
    Commander,
    CommanderChanged,
    Condition,
    ConditionChanged,
    EndReason,
    GameEnded,
    HandbackRequested,
    RobotDeparted,
    TreasureLeft,
)
from thbridge.hunt.game import CommandHolder, apply
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.rules import RuleReason

STATION = CommandHolder(Commander.GROUND_STATION, "ground station 255")
PARTICIPANT = CommandHolder()


def taken(state=None, robot=0, by=STATION):
    state = new_game() if state is None else state
    return after(state, rules.command(state, robot, by))


def test_a_ground_station_takes_a_robot_and_gives_it_back():
    state = new_game()
    assert state.robots[0].command == PARTICIPANT
    assert rules.command(state, 0, STATION) == (CommanderChanged(0, Commander.GROUND_STATION, "ground station 255"),)
    state = taken(state)
    assert (state.robots[0].command, state.robots[1].command) == (STATION, PARTICIPANT)
    assert rules.command(state, 0, STATION) == ()
    assert taken(state, by=PARTICIPANT).robots[0].command == PARTICIPANT


def test_another_ground_station_may_have_it_next():
    other = CommandHolder(Commander.GROUND_STATION, "ground station 7")
    assert taken(taken(), by=other).robots[0].command == other


def test_only_its_commander_moves_a_robot():
    state = taken()
    refused = rules.move(state, 0, ROOM_4)
    assert refused == RequestRefused(RuleReason.COMMANDED, "Robot 1 is commanded by ground station 255 just now.")
    assert rules.move(state, 0, ROOM_4, Commander.GROUND_STATION) == (RobotDeparted(0, ROOM_4, 13.0),)
    assert rules.move(state, 1, ROOM_4) == (RobotDeparted(1, ROOM_4, 13.0),)
    refused = rules.move(state, 1, ROOM_4, Commander.GROUND_STATION)
    assert refused == RequestRefused(RuleReason.COMMANDED, "Robot 2 is commanded by the participant just now.")


def test_energy_and_reservations_hold_for_ground_stations_too():
    state = taken(new_game(energy=5.0))
    refused = rules.move(state, 0, ROOM_4, Commander.GROUND_STATION)
    assert isinstance(refused, RequestRefused) and refused.reason == RuleReason.NOT_ENOUGH_ENERGY
    state = new_game()
    state = taken(after(state, rules.move(state, 1, ROOM_4)))
    refused = rules.move(state, 0, ROOM_4, Commander.GROUND_STATION)
    assert isinstance(refused, RequestRefused) and refused.reason == RuleReason.RESERVED


def test_a_robot_under_way_goes_on_under_its_new_commander():
    state = new_game()
    state = taken(after(state, rules.move(state, 0, ROOM_4)))
    assert state.robots[0].bound_for == ROOM_4
    state = after(state, rules.arrive(state, 0, ROOM_4))
    assert state.room(ROOM_4).visited and state.robots[0].command == STATION


def test_what_a_machine_found_is_still_named_by_the_participant():
    state = taken(in_room_4())
    for ruling in (rules.picture(state, ROOM_4), rules.identify(state, ROOM_4, "Pink can"), rules.leave(state, ROOM_4)):
        assert isinstance(ruling, tuple)


def sent_on(**options):
    state = taken(in_room_4(**options))
    return after(state, rules.move(state, 0, ROOM_1, Commander.GROUND_STATION))


def test_only_a_participant_who_moves_a_robot_on_gives_up_what_is_not_decided():
    left, departed = rules.move(in_room_4(), 0, ROOM_1)
    assert (left, departed.room) == (TreasureLeft(ROOM_4), ROOM_1)
    (departed,) = rules.move(taken(in_room_4()), 0, ROOM_1, Commander.GROUND_STATION)
    assert departed.room == ROOM_1


def test_what_a_robot_was_sent_on_from_is_named_at_its_expense_and_not_pictured():
    state = sent_on()
    for there in (state, after(state, rules.arrive(state, 0, ROOM_1))):
        (named,) = rules.identify(there, ROOM_4, "Orange Bottle")
        assert (named.robot, named.points, named.cost) == (0, 10, 2.0)
        energy = there.robots[0].energy
        named = after(there, (named,))
        assert (named.score, named.robots[0].energy) == (10, energy - 2.0)
        assert named.decider(ROOM_4) is None
        assert rules.picture(there, ROOM_4) == RequestRefused(RuleReason.NOBODY_THERE, "No robot stands in room 4.")
        assert rules.leave(there, ROOM_4) == (TreasureLeft(ROOM_4),)


def test_nobody_names_what_was_given_up_or_never_sensed_once_its_robot_is_gone():
    state = after(in_room_4(), rules.move(in_room_4(), 0, ROOM_1))
    assert state.decider(ROOM_4) is None
    state = taken(visit(new_game(), 0, ROOM_4))
    state = after(state, rules.move(state, 0, ROOM_1, Commander.GROUND_STATION))
    assert state.decider(ROOM_4) is None


def test_nobody_names_anything_in_a_room_that_there_is_not():
    assert sent_on().decider(Room(9)) is None
    # In the corridor robots stand, but nothing lies there.
    assert new_game().decider(Room(0)) == new_game().standing_in(Room(0))


def test_a_robot_that_does_not_answer_names_nothing_that_it_found():
    state = apply(sent_on(), ConditionChanged(0, Condition.SILENT))
    refused = rules.identify(state, ROOM_4, "Pink can")
    assert isinstance(refused, RequestRefused) and refused.reason is RuleReason.SILENT


def test_a_robot_that_stops_at_once_stands_beside_its_find_as_before():
    state = sent_on()
    state = after(state, rules.fail(state, 0, "stopped", 0.0))
    assert state.standing_in(ROOM_4) == state.decider(ROOM_4) == 0
    assert isinstance(rules.picture(state, ROOM_4), tuple)


@pytest.mark.parametrize(("identify_cost", "waits"), [(2.0, True), (95.0, False)])
def test_the_end_waits_for_what_can_be_named_from_afar_if_anybody_is_there_to_do_it(identify_cost, waits):
    state = small_game(identify_cost=identify_cost)
    state = visit(state, 0, ROOM_1)
    state = taken(after(state, rules.sense(state, ROOM_1)))
    state = after(state, rules.move(state, 0, ROOM_2, Commander.GROUND_STATION))
    state = after(state, rules.arrive(state, 0, ROOM_2))
    state = after(state, rules.leave(state, ROOM_2))
    assert bool(rules.ending(state)) != waits
    assert rules.ending(state, wait_for_decisions=False)
    assert rules.ending(after(state, rules.leave(state, ROOM_1)))


def test_the_participant_asks_for_what_somebody_else_commands():
    state = taken()
    assert rules.request_handback(state, 0) == (HandbackRequested(0),)
    state = after(after(state, rules.request_handback(state, 0)), rules.request_handback(state, 0))
    assert state.robots[0].asked_back == 2
    assert rules.request_handback(state, 1) == ()
    assert taken(state, by=PARTICIPANT).robots[0].asked_back == 0
    assert rules.request_handback(after(state, rules.intervene(state, 1, "/rviz")), 1) == (HandbackRequested(1),)
    for refused in (
        rules.request_handback(state, 2),
        rules.request_handback(apply(state, GameEnded(EndReason.GIVEN_UP, 0)), 0),
    ):
        assert isinstance(refused, RequestRefused)


@pytest.mark.parametrize("holder", [STATION, PARTICIPANT])
def test_a_researcher_who_intervenes_gives_the_robot_back_to_whoever_had_it(holder):
    state = taken(by=holder)
    state = after(state, rules.intervene(state, 0, "/rviz"))
    assert state.robots[0].command == CommandHolder(Commander.RESEARCHER, "/rviz")
    assert rules.intervene(state, 0, "/rviz") == ()
    refused = rules.move(state, 0, ROOM_4, holder.by)
    assert refused == RequestRefused(RuleReason.COMMANDED, "Robot 1 is commanded by a researcher just now.")
    assert rules.intervene(state, 0, None) == (CommanderChanged(0, holder.by, holder.name),)
    state = after(state, rules.intervene(state, 0, None))
    assert state.robots[0].command == holder
    assert rules.intervene(state, 0, None) == ()


def test_a_ground_station_that_leaves_meanwhile_does_not_end_what_a_researcher_does():
    state = taken()
    state = after(state, rules.intervene(state, 0, "/rviz"))
    state = taken(state, by=PARTICIPANT)
    assert state.robots[0].command.by is Commander.RESEARCHER
    assert after(state, rules.intervene(state, 0, None)).robots[0].command == PARTICIPANT


def test_command_is_given_back_after_the_end_of_the_game_too():
    state = apply(taken(), GameEnded(EndReason.GIVEN_UP, 0))
    assert taken(state, by=PARTICIPANT).robots[0].command == PARTICIPANT


def test_there_is_no_command_of_robots_that_there_are_not():
    for ruling in (rules.command(new_game(), 2, STATION), rules.intervene(new_game(), -1, "/rviz")):
        assert isinstance(ruling, RequestRefused) and ruling.reason == RuleReason.UNKNOWN_ROBOT


def test_the_last_treasure_waits_for_a_ground_station_at_it_whoever_else_is_there():
    state = visit(visit(small_game(), 0, ROOM_1), 0, ROOM_2)
    (ended,) = rules.ending(state, wait_for_decisions=False)
    held = taken(state)
    assert rules.ending(held, wait_for_decisions=False) == ()
    assert rules.ending(taken(held, by=PARTICIPANT), wait_for_decisions=False) == (ended,)


def test_arrivals_and_endings_do_not_ask_who_commands():
    state = visit(new_game(robots=1), 0, ROOM_1)
    assert rules.ending(taken(state)) == rules.ending(state)


commands = st.sampled_from([STATION, PARTICIPANT, CommandHolder(Commander.GROUND_STATION, "ground station 7")])
researchers = st.sampled_from(["/rviz", "/teleop", None])


@given(st.lists(st.tuples(st.just("command"), commands) | st.tuples(st.just("intervene"), researchers), max_size=12))
def test_the_holder_is_whoever_took_it_last_and_a_researcher_goes_before(asked):
    state, holder, researcher = new_game(), PARTICIPANT, None
    for what, who in asked:
        if what == "command":
            holder = who
            state = taken(state, by=who)
        else:
            researcher = who
            state = after(state, rules.intervene(state, 0, who))
        expected = holder if researcher is None else CommandHolder(Commander.RESEARCHER, researcher)
        assert (state.robots[0].command, state.robots[0].holder) == (expected, holder)
