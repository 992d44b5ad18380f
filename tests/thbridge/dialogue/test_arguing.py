"""Dialogues in which a robot argues: whatever a person does, and whatever the robot knows."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.dialogue.argued_topics import (
    FACTS,
    MOST_TURNS,
    answered,
    formal_engine,
    manners,
    play_to_the_end,
    topics,
    topics_of,
)
from tests.support.dialogue.random_facts import where_facts
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.engine import DialogueStep
from thbridge.dialogue.games.contents import DialogueMove, Unknown, propositions_in
from thbridge.dialogue.games.strategies import Attitude
from thbridge.dialogue.games.tables import DialogueEnd
from thbridge.dialogue.moves import (
    CloseQuestions,
    Conclude,
    DialogueOutcome,
    DialogueTopic,
    Echo,
    Enquire,
    Explain,
    Leave,
    OpenQuestions,
    Override,
    Question,
    Scenario,
    Speaker,
    Upshot,
)
from thbridge.dialogue.propositions import CostsMore, InTheWay, NextRoom, Wanted
from thbridge.dialogue.robot_arguments import WhatFacts, WhereFacts
from thbridge.dialogue.worded import WordedPhrasing
from thbridge.files.word_files import read_language
from thbridge.hunt.rooms import Room


@given(topics(), manners, st.data())
def test_every_dialogue_ends_and_offers_five_choices_at_most(
    topic: DialogueTopic, manner: Manner, draw: st.DataObject
) -> None:
    talker = formal_engine(manner)
    step = play_to_the_end(talker, talker.open(1, topic), draw)
    assert talker.choices(step.dialogue) == () or step.outcome is not None
    # What is said is recorded word by word, and can be said again from the record.
    assert [said.text for said in talker.utterances(step.dialogue) if not isinstance(said.move, Conclude)] == [
        str(turn.said or turn.move) for turn in step.dialogue.turns
    ]


@given(topics(), manners, st.data())
def test_a_robot_says_only_what_it_believes(topic: DialogueTopic, manner: Manner, draw: st.DataObject) -> None:
    talker = formal_engine(manner)
    step = talker.open(1, topic)
    while step.outcome is None and len(step.dialogue.turns) < MOST_TURNS:
        before = len(step.dialogue.turns)
        step = talker.move(step.dialogue, draw.draw(st.sampled_from(talker.choices(step.dialogue))).move)
        conversation = step.dialogue.conversation
        assert conversation is not None
        held = {literal.proposition for literal in conversation.agents[Side.ROBOT].beliefs.origins}
        for turn in step.dialogue.turns[before:]:
            if turn.speaker is not Speaker.ROBOT:
                continue
            if isinstance(turn.move, Explain) and turn.move.question in {Question.WHY_THIS, Question.WHY_NOT}:
                assert {literal.proposition for literal in turn.move.because} <= held
            if isinstance(turn.move, DialogueMove) and turn.move.locution in {"assert", "accept"}:
                told = propositions_in(turn.move.content)
                assert told.isdisjoint(held) if isinstance(turn.move.content, Unknown) else told <= held


@given(topics(), manners, st.data())
def test_a_robot_that_agreed_believes_what_was_agreed_upon(
    topic: DialogueTopic, manner: Manner, draw: st.DataObject
) -> None:
    talker = formal_engine(manner)
    step = play_to_the_end(talker, talker.open(1, topic), draw)
    agreed = step.outcome is DialogueOutcome.CONSENSUS
    overridden = any(isinstance(turn.move, Override) for turn in step.dialogue.turns)
    if agreed and not overridden and isinstance(topic.facts, WhereFacts) and step.dialogue.conversation:
        goes = Literal(NextRoom(0, step.dialogue.topic.room))
        assert goes in step.dialogue.conversation.agents[Side.ROBOT].beliefs


@given(topics(), st.data())
def test_a_collaborator_does_nothing_that_one_of_both_does_not_want(topic: DialogueTopic, draw: st.DataObject) -> None:
    talker = formal_engine(Manner())
    step = play_to_the_end(talker, talker.open(1, topic), draw)
    moves = [turn.move for turn in step.dialogue.turns]
    if step.outcome is DialogueOutcome.CONSENSUS and moves:
        assert isinstance(moves[-1], DialogueMove) and moves[-1].locution == "accept"
    assert not any(isinstance(move, Override) for move in moves)


@pytest.mark.parametrize("persistence", [0, 1, 2])
def test_a_robot_gives_in_when_it_has_held_out_for_as_long_as_it_is_persistent(persistence: int) -> None:
    talker = formal_engine(Manner(persistence=persistence))
    step = talker.open(1, DialogueTopic(Scenario.SPECIFIC_ROOM, 0, Room(1), 50.0, 500.0, facts=FACTS))
    claim = "assert(next(Robot1, Room1))"
    for held_out in range(persistence):
        assert step.outcome is None
        if held_out == 0:
            step = answered(talker, step, "challenge(not next(Robot1, Room1))")
            step = answered(talker, step, "reject(not next(Robot1, Room1))")
        else:
            step = answered(talker, step, "assert(wanted(next(Robot1, Room1)))")
        step = answered(talker, step, claim)
    assert step.outcome is DialogueOutcome.CONSENSUS
    assert step.dialogue.topic.room == Room(1)


def test_a_robot_believes_that_something_is_in_the_way_and_goes_elsewhere() -> None:
    talker = formal_engine(Manner())
    topic = DialogueTopic(Scenario.DONT_KNOW, 0, Room(2), 80.0, 500.0, facts=FACTS, opener=Speaker.ROBOT)
    step = talker.open(1, topic)
    assert str(step.dialogue.turns[0].move) == "assert(next(Robot1, Room2))"
    step = answered(talker, step, "assert(not next(Robot1, Room2))")
    assert str(step.dialogue.turns[-1].move) == "challenge(not next(Robot1, Room2))"
    step = answered(talker, step, "assert(in_the_way(Room2))")
    assert "accept(in_the_way(Room2))" in [str(turn.move) for turn in step.dialogue.turns]
    assert step.outcome is None
    step = answered(talker, step, "question(next(Robot1, Room1))")
    assert str(step.dialogue.turns[-1].move) == "assert(next(Robot1, Room1))"
    step = answered(talker, step, "accept(next(Robot1, Room1))")
    assert step.outcome is DialogueOutcome.CONSENSUS and step.dialogue.topic.room == Room(1)


def test_of_a_room_that_comes_later_in_its_tour_the_robot_argues_for_the_order() -> None:
    talker = formal_engine(Manner())
    facts = replace(FACTS, tour=(Room(2), Room(3), Room(1)))
    step = talker.open(1, DialogueTopic(Scenario.SPECIFIC_ROOM, 0, Room(1), 50.0, 500.0, facts=facts))
    step = answered(talker, step, "accept(not next(Robot1, Room1))")
    order = "order(1, Room2) and order(2, Room3) and order(3, Room1)"
    step = answered(talker, step, f"question({order})")
    assert str(step.dialogue.turns[-1].move) == f"assert({order})"
    step = answered(talker, step, f"challenge({order})")
    assert "plan(Robot1, Room2, 3, 250)" in str(step.dialogue.turns[-1].move)
    step = answered(talker, step, f"accept({order})")
    assert step.outcome is DialogueOutcome.CONSENSUS and step.dialogue.topic.room == Room(2)


def test_a_dearer_way_by_what_it_says_would_change_its_mind() -> None:
    talker = formal_engine(Manner())
    step = talker.open(1, DialogueTopic(Scenario.DONT_KNOW, 0, Room(2), 80.0, 500.0, facts=FACTS))
    step = talker.move(step.dialogue, OpenQuestions())
    change = next(choice.move for choice in talker.choices(step.dialogue) if "CHANGE" in choice.text)
    answer = talker.move(step.dialogue, change).dialogue.turns[-1].move
    assert isinstance(answer, Explain)
    (dearer,) = (each.proposition for each in answer.because if isinstance(each.proposition, CostsMore))
    assert dearer == CostsMore(Room(0), Room(2), 130.0)


def test_a_robot_that_has_misheard_says_what_it_has_understood() -> None:
    talker = formal_engine(Manner(misheard=1.0))
    step = talker.open(1, DialogueTopic(Scenario.DONT_KNOW, 0, Room(2), 80.0, 500.0, facts=FACTS))
    step = answered(talker, step, "accept(next(Robot1, Room2))")
    hers, echo = step.dialogue.turns[2:4]
    assert (str(hers.said), str(hers.move)) == ("accept(next(Robot1, Room2))", "challenge(next(Robot1, Room2))")
    assert echo.move == Echo("challenge(next(Robot1, Room2))")
    assert step.utterances[0].text == "accept(next(Robot1, Room2))"
    assert step.outcome is None


def test_a_wish_is_no_reason_for_a_robot_that_has_better_ones() -> None:
    assert Wanted(Literal(NextRoom(0, Room(1)))).is_wish
    talker = formal_engine(Manner())
    step = talker.open(1, DialogueTopic(Scenario.SPECIFIC_ROOM, 0, Room(1), 50.0, 500.0, facts=FACTS))
    step = answered(talker, step, "challenge(not next(Robot1, Room1))")
    step = answered(talker, step, "reject(not next(Robot1, Room1))")
    step = answered(talker, step, "assert(next(Robot1, Room1))")
    step = answered(talker, step, "assert(wanted(next(Robot1, Room1)))")
    assert step.outcome is None
    assert str(step.dialogue.turns[-1].move) == "reject(next(Robot1, Room1))"


def refused_by_the_person(manner: Manner, *, held: bool = False) -> tuple[ArguingEngine, DialogueStep]:
    """A robot has said why it would go to room 2, and she has refused the first of its reasons."""
    talker = formal_engine(manner)
    topic = DialogueTopic(Scenario.DONT_KNOW, 0, Room(2), 80.0, 500.0, facts=FACTS, opener=Speaker.ROBOT)
    step = answered(talker, talker.open(1, topic), "challenge(next(Robot1, Room2))")
    no = next(choice.move for choice in talker.choices(step.dialogue) if choice.text == "reject(next(Robot1, Room2))")
    return talker, talker.move(step.dialogue, no, held=held)


PLAN = "plan(Robot1, Room1, 3, 300)"


def test_a_robot_whose_reason_was_refused_asks_whether_it_is_not_so_and_she_may_accept_it_after_all() -> None:
    talker, step = refused_by_the_person(Manner(talkative=True))
    assert str(step.dialogue.turns[-1].move) == f"question(not {PLAN})"
    answers = [f"assert({PLAN})", f"assert(U({PLAN}))", f"assert(not {PLAN})"]
    assert [choice.text for choice in talker.choices(step.dialogue)][:3] == answers
    step = answered(talker, step, f"assert(U({PLAN}))")
    assert [choice.text for choice in talker.choices(step.dialogue)][:2] == [f"accept({PLAN})", f"reject({PLAN})"]
    accepted = answered(talker, step, f"accept({PLAN})")
    while accepted.outcome is None:
        accepted = talker.move(accepted.dialogue, talker.choices(accepted.dialogue)[0].move)
    assert accepted.outcome is DialogueOutcome.CONSENSUS and accepted.dialogue.topic.room == Room(2)
    # For good it is said once, and asked about no more.
    step = answered(talker, step, f"reject({PLAN})")
    assert step.outcome is None and str(step.dialogue.turns[-1].move) == f"reject({PLAN})"


def test_what_she_holds_against_it_a_robot_asks_her_to_argue_for_and_says_nothing_twice() -> None:
    talker, step = refused_by_the_person(Manner(talkative=True))
    step = answered(talker, step, f"assert(not {PLAN})")
    assert str(step.dialogue.turns[-1].move) == f"challenge(not {PLAN})"
    step = answered(talker, step, f"reject({PLAN})")
    moves = [turn.move for turn in step.dialogue.turns if turn.speaker is Speaker.ROBOT]
    assert len(set(moves)) == len(moves)


@pytest.mark.parametrize("manner", [Manner(talkative=True, persistence=0), Manner(talkative=False)])
def test_a_robot_that_gives_in_at_once_or_argues_in_brief_takes_a_no(manner: Manner) -> None:
    _, step = refused_by_the_person(manner)
    assert str(step.dialogue.turns[-1].move) == "reject(next(Robot1, Room2))"


def test_whoever_speaks_for_a_robot_asks_in_its_place_and_until_then_nothing_has_come_of_it() -> None:
    talker, step = refused_by_the_person(Manner(talkative=True), held=True)
    assert talker.choices(step.dialogue) == ()
    (asks,) = talker.choices(step.dialogue, Speaker.ROBOT)
    step = talker.speak(step.dialogue, asks.move)
    step = answered(talker, step, f"assert(U({PLAN}))")
    assert not any(isinstance(each.move, Conclude) for each in talker.utterances(step.dialogue))
    assert [choice.text for choice in talker.choices(step.dialogue)][:2] == [f"accept({PLAN})", f"reject({PLAN})"]


def test_who_leaves_in_the_middle_of_a_question_leaves_all_of_it() -> None:
    talker, step = refused_by_the_person(Manner(talkative=True))
    step = talker.move(step.dialogue, Leave())
    assert step.outcome is DialogueOutcome.NO_CONSENSUS
    conversation = step.dialogue.conversation
    assert conversation is not None and conversation.open_plays == ()
    assert [play.end for play in conversation.plays] == [
        DialogueEnd.DISAGREEMENT,
        DialogueEnd.WITHDRAWN,
    ]


@pytest.mark.parametrize("talkative", [True, False])
@pytest.mark.parametrize("condition", [DialogueCondition.COLLABORATOR, DialogueCondition.ADVISER])
def test_a_person_may_ask_about_her_reason_that_was_refused_but_not_about_a_wish(
    condition: DialogueCondition, talkative: bool
) -> None:
    talker = formal_engine(Manner(condition, Attitude.SCEPTICAL, talkative=talkative))
    topic = DialogueTopic(Scenario.DONT_KNOW, 0, Room(2), 80.0, 500.0, facts=FACTS, opener=Speaker.ROBOT)
    defended = answered(talker, talker.open(1, topic), "assert(not next(Robot1, Room2))")
    wish = answered(talker, defended, "assert(wanted(not next(Robot1, Room2)))")
    assert not any(choice.text.startswith("question(not") for choice in talker.choices(wish.dialogue))
    step = answered(talker, defended, "assert(in_the_way(Room2))")
    assert str(step.dialogue.turns[-1].move) == "reject(not next(Robot1, Room2))"
    asks = DialogueMove("question", ~Literal(InTheWay(Room(2))))
    worded = WordedPhrasing(read_language(), condition, seed=3)
    assert worded.say(step.dialogue, asks, Speaker.PERSON) == "Do you think that nothing is in the way to room 2?"
    step = answered(talker, step, str(asks))
    answers = ["assert(U(in_the_way(Room2)))", "reject(in_the_way(Room2))"]
    assert [str(turn.move) for turn in step.dialogue.turns[-2:]] == answers
    assert step.outcome is None
    assert not any(choice.text == "question(not in_the_way(Room2))" for choice in talker.choices(step.dialogue))


@given(topics(), manners, st.data())
def test_utterances_tell_every_formal_move_and_what_was_misheard(
    topic: DialogueTopic, manner: Manner, draw: st.DataObject
) -> None:
    talker = formal_engine(manner)
    step = talker.open(1, topic)
    utterances = step.utterances
    while step.outcome is None and len(step.dialogue.turns) < MOST_TURNS:
        step = talker.move(step.dialogue, draw.draw(st.sampled_from(talker.choices(step.dialogue))).move)
        utterances += step.utterances
    assert step.dialogue.conversation is not None
    assert tuple(move for said in utterances for move in said.formal) == step.dialogue.conversation.record
    assert [said.text for said in utterances] == [said.text for said in talker.utterances(step.dialogue)]
    turns = (said for said in utterances if not isinstance(said.move, Conclude))
    for said, turn in zip(turns, step.dialogue.turns, strict=True):
        assert said.heard == ("" if turn.said is None else str(turn.move))
        assert bool(said.formal) == isinstance(turn.move, DialogueMove)
        assert said.formal == () or said.formal[0].move == turn.move


def test_a_misheard_answer_to_a_question_of_the_robots_is_told_again_as_it_was() -> None:
    manner = Manner(DialogueCondition.COLLABORATOR, Attitude.CREDULOUS, 1, talkative=True, gives_reasons=False)
    talker = formal_engine(replace(manner, misheard=0.5))
    facts = WhatFacts(Room(1), 1.0, 0.0, 0.0, ("cup",), has_picture=False)
    step = talker.open(1, DialogueTopic(Scenario.TAKE_PICTURE, 0, Room(1), 0.0, 1.0, facts=facts))
    live = step.utterances
    for text in (
        "accept(not picture(Room1))",
        "accept(picture_cost(0))",
        "accept(settled(Room1, cup))",
        "question(name(Room1))",
        "accept(name(Room1))",
        "accept(current_energy_level(1))",
        "assert(current_energy_level(1))",
        "Leave()",
    ):
        step = answered(talker, step, text)
        live += step.utterances
    assert [said.text for said in talker.utterances(step.dialogue)] == [said.text for said in live]


@given(where_facts().flatmap(topics_of), manners, st.sampled_from(Speaker), st.data())
def test_nothing_that_a_robot_suggests_is_agreed_upon_before_the_person_has_answered(
    topic: DialogueTopic, manner: Manner, opener: Speaker, draw: st.DataObject
) -> None:
    talker = formal_engine(manner)
    former = play_to_the_end(talker, talker.open(1, topic), draw).dialogue.conversation
    suggestion = replace(topic, scenario=Scenario.DONT_KNOW, opener=opener)
    assert talker.open(2, suggestion, former=former).outcome is not DialogueOutcome.CONSENSUS


@given(topics(), manners, st.data())
def test_a_person_never_has_the_last_word_without_hearing_what_comes_of_it(
    topic: DialogueTopic, manner: Manner, draw: st.DataObject
) -> None:
    talker = formal_engine(manner)
    step = talker.open(1, topic)
    while step.outcome is None and len(step.dialogue.turns) < MOST_TURNS:
        step = talker.move(step.dialogue, draw.draw(st.sampled_from(talker.choices(step.dialogue))).move)
        last, conversation = talker.utterances(step.dialogue)[-1], step.dialogue.conversation
        # Asked about a no of hers, she accepts or refuses for good after her answer.
        goes_on = conversation is not None and any(play.put_off is not None for play in conversation.open_plays)
        about_questions = isinstance(last.move, OpenQuestions | CloseQuestions)
        assert last.speaker is Speaker.ROBOT or about_questions or goes_on
    told = [said for said in talker.utterances(step.dialogue) if isinstance(said.move, Conclude)]
    assert all(said.move.about is None for said in told[:-1]), "only the last one does something"
    if told and step.outcome is DialogueOutcome.CONSENSUS and talker.utterances(step.dialogue)[-1] is told[-1]:
        assert told[-1].move.about is not None
    if told and step.outcome is not DialogueOutcome.CONSENSUS:
        assert told[-1].move.about is None


def upshots(talker: ArguingEngine, step: DialogueStep) -> list[tuple[Upshot, str]]:
    moves = [said.move for said in talker.utterances(step.dialogue)]
    return [(move.upshot, str(move.about)) for move in moves if isinstance(move, Conclude)]


def test_what_comes_of_it_is_told_by_who_had_the_last_word() -> None:
    asked = DialogueTopic(Scenario.DONT_KNOW, 0, Room(2), 80.0, 500.0, facts=FACTS)
    wanted = DialogueTopic(Scenario.SPECIFIC_ROOM, 0, Room(1), 50.0, 500.0, facts=FACTS)
    talker = formal_engine(Manner())
    assert upshots(talker, answered(talker, talker.open(1, asked), "accept(next(Robot1, Room2))")) == [
        (Upshot.AGREED, "next(Robot1, Room2)")
    ]
    step = answered(talker, talker.open(1, wanted), "accept(not next(Robot1, Room1))")
    assert upshots(talker, step) == [(Upshot.STAYS, "None")]
    step = answered(talker, answered(talker, step, "question(next(Robot1, Room2))"), "accept(next(Robot1, Room2))")
    assert upshots(talker, step) == [(Upshot.STAYS, "None"), (Upshot.AGREED, "next(Robot1, Room2)")]
    adviser = formal_engine(Manner(DialogueCondition.ADVISER))
    step = adviser.move(adviser.open(1, wanted).dialogue, Override())
    assert upshots(adviser, step) == [(Upshot.OVERRIDDEN, "next(Robot1, Room1)")]
    autonomous = formal_engine(Manner(DialogueCondition.AUTONOMOUS))
    step = answered(autonomous, autonomous.open(1, wanted), "challenge(not next(Robot1, Room1))")
    step = answered(autonomous, step, "reject(not next(Robot1, Room1))")
    assert upshots(autonomous, step) == [(Upshot.DECIDED, "next(Robot1, Room2)")]


def test_what_is_said_more_simply_are_the_last_reasons_and_never_what_would_be_as_if_it_were() -> None:
    talker = formal_engine(Manner())
    topic = DialogueTopic(Scenario.DONT_KNOW, 0, Room(2), 80.0, 500.0, facts=FACTS)
    step = talker.open(1, topic)
    simpler = Enquire(Question.SIMPLER)

    def ask(step: DialogueStep, question: Question) -> Explain:
        step = talker.move(step.dialogue, OpenQuestions())
        asked = next(each.move for each in talker.choices(step.dialogue) if question.name in each.text)
        answer = talker.move(step.dialogue, asked)
        again = talker.move(answer.dialogue, OpenQuestions())
        assert (simpler in [each.move for each in talker.choices(again.dialogue)]) == (question is not Question.SIMPLER)
        if question is Question.SIMPLER:
            return answer.dialogue.turns[-1].move
        return talker.move(again.dialogue, simpler).dialogue.turns[-1].move

    assert simpler not in [each.move for each in talker.choices(talker.move(step.dialogue, OpenQuestions()).dialogue)]
    assert ask(step, Question.CHANGE).restates is Question.CHANGE
    argued = answered(talker, step, "challenge(next(Robot1, Room2))")
    because = ask(argued, Question.SIMPLER).because
    assert {str(each) for each in because} >= {"plan(Robot1, Room2, 3, 250)"}
    offered = talker.choices(talker.move(argued.dialogue, OpenQuestions()).dialogue)
    assert Question.WHY_THIS not in [each.move.question for each in offered if isinstance(each.move, Enquire)]
