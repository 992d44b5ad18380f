"""Evidence of a robot: its decision follows from it, and every comparison in it is true."""

from hypothesis import given

from tests.support.dialogue.random_facts import where_facts
from thbridge.dialogue.argumentation.beliefs import Beliefs, Source
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.propositions import FewerRooms, InTheWay, LessThan, NamesTreasure, NextRoom, TakesPicture
from thbridge.dialogue.robot_arguments import WhatFacts, WhereFacts, comparison, what, where
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_tour import PlanValue


@given(where_facts())
def test_a_decision_is_argued_for_and_nothing_stands_against_it(facts: WhereFacts) -> None:
    evidence = where(facts)
    if evidence.decision is None:
        assert not (set(facts.values) - set(facts.under_way) - facts.failed)
        return
    goes = evidence.decision.proposition
    assert isinstance(goes, NextRoom)
    assert not evidence.beliefs.arguments(~evidence.decision)
    values = [
        (-facts.values[room].rooms, facts.values[room].cost)
        for room in facts.values
        if room not in facts.under_way and room not in facts.failed
    ]
    chosen = facts.values[goes.room]
    assert (-chosen.rooms, chosen.cost) == min(values)


@given(where_facts())
def test_every_comparison_is_true_and_every_room_that_is_worse_has_an_argument_against_it(facts: WhereFacts) -> None:
    evidence = where(facts)
    for literal in evidence.beliefs.origins:
        if isinstance(literal.proposition, LessThan | FewerRooms):
            assert literal.holds and literal.proposition.is_true
    if evidence.decision is None or not isinstance(goes := evidence.decision.proposition, NextRoom):
        return
    best = facts.values[goes.room]
    for room, value in facts.values.items():
        if (value.rooms, -value.cost) < (best.rooms, -best.cost):
            assert evidence.beliefs.arguments(Literal(NextRoom(0, room), holds=False))


@given(where_facts())
def test_a_robot_that_was_told_of_something_in_the_way_decides_for_another_room(facts: WhereFacts) -> None:
    before = where(facts).decision
    if before is None or not isinstance(before.proposition, NextRoom):
        return
    told = Beliefs.of([Literal(InTheWay(before.proposition.room))], source=Source.TOLD)
    assert where(facts, told).decision != before


@given(where_facts())
def test_a_robot_that_was_persuaded_goes_there_whatever_its_plan_is_worth(facts: WhereFacts) -> None:
    for room in facts.left:
        goes = Literal(NextRoom(0, room))
        assert where(facts, Beliefs.of([goes], source=Source.TOLD)).decision == goes


def test_a_picture_is_worth_its_price_only_while_several_names_fit() -> None:
    room = Room(3)
    several = what(WhatFacts(room, 500.0, 50.0, 10.0, ("cup", "vase"), has_picture=False))
    assert several.decision == Literal(TakesPicture(room))
    settled = what(WhatFacts(room, 500.0, 50.0, 10.0, ("vase",), has_picture=False))
    assert settled.decision == Literal(NamesTreasure(room))
    (waste,) = settled.beliefs.arguments(Literal(TakesPicture(room), holds=False))
    assert {str(each) for each in waste.support} == {"settled(Room3, vase)", "picture_cost(50)"}
    poor = what(WhatFacts(room, 55.0, 50.0, 10.0, ("cup", "vase"), has_picture=False))
    assert poor.decision is None
    assert poor.beliefs.arguments(Literal(TakesPicture(room), holds=False))


def test_what_people_would_read_as_the_same_energy_is_no_reason() -> None:
    near = PlanValue(3, 250.004)
    assert comparison(PlanValue(3, 250.0), near) is None
    assert comparison(PlanValue(3, 249.99), near) == LessThan((249.99,), 250.004)
