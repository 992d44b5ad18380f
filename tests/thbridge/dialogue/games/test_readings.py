"""What the paper leaves open or contradicts itself in, an example a reading; and that equal input is equal talk."""

import os
import subprocess
import sys
from collections.abc import Collection
from dataclasses import replace

import pytest

from tests.support.project import ROOT
from tests.thbridge.dialogue.games.judge import Fact
from tests.thbridge.dialogue.games.small_conversations import (
    HUMAN,
    IMPLIES,
    ROBOT,
    RULEBOOK,
    A,
    B,
    C,
    conversation,
    legal,
    opened,
    said,
    side,
)
from thbridge.dialogue.argumentation.beliefs import Source
from thbridge.dialogue.argumentation.cases import DialogueKind, Side
from thbridge.dialogue.argumentation.propositions import Literal, Rule
from thbridge.dialogue.games.contents import Unknown
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.locutions import CONDITIONS, Utterer
from thbridge.dialogue.games.tables import DialogueEnd, GameRole, GameStage, GameTable, Reply, Rulebook, Slot


def test_what_can_be_derived_is_not_held_so_that_it_can_be_proposed() -> None:
    robot = side(ROBOT, [A], [IMPLIES])
    assert robot.beliefs.arguments(B)
    now = conversation(robot, side(HUMAN, is_person=True))
    assert now.case(B.proposition).kind is DialogueKind.INQUIRY
    assert [str(each.move) for each in now.openings(ROBOT, B.proposition)] == ["propose(a -> b)"]
    assert now.opening(ROBOT, "persuasion", B) == ()


def test_the_picture_of_the_other_is_no_part_of_one_s_own_beliefs() -> None:
    now = conversation(side(ROBOT, hers=[B]), side(HUMAN, is_person=True))
    assert now.case(B.proposition).number == 3
    now = said(opened(now, ROBOT, "information-seeking", B), "assert(b)")
    assert B in now.agents[ROBOT].picture and B not in now.agents[ROBOT].beliefs
    assert B in said(now, "accept(b)").agents[ROBOT].beliefs


@pytest.mark.parametrize("is_person", [True, False])
def test_a_disbelief_never_bars_that_one_is_persuaded(is_person: bool) -> None:
    human = side(HUMAN, [~B], hers=[~B], is_person=is_person)
    now = opened(conversation(side(ROBOT, [B], hers=[~B]), human), ROBOT, "persuasion", B)
    now = said(now, "accept(b)")
    assert now.play(1).end is DialogueEnd.AGREEMENT
    assert B in now.agents[HUMAN].beliefs and ~B not in now.agents[HUMAN].beliefs
    assert B in now.agents[ROBOT].picture and ~B not in now.agents[ROBOT].picture


def test_a_decision_supports_itself_no_more_than_a_wish_and_needs_other_premises() -> None:
    human = side(HUMAN, is_person=True)
    decided = side(ROBOT, [B], source=Source.DECIDED)
    assert conversation(decided, human).opening(ROBOT, "persuasion", B) == ()
    sensed = side(ROBOT, [B])
    assert conversation(sensed, human).opening(ROBOT, "persuasion", B) != ()


def test_an_observation_is_all_the_support_there_is_and_is_weighed_not_said_again() -> None:
    now = opened(conversation(side(ROBOT, [B]), side(HUMAN, is_person=True)), ROBOT, "persuasion", B)
    now = said(now, "challenge(b)", "assert({b}, b)")
    assert now.play(1).speaker is HUMAN
    assert legal(now) == {"accept(b)", "reject(b)"}


def test_nothing_left_to_say_is_a_stalemate_and_only_a_no_is_disagreement() -> None:
    human = side(HUMAN, is_person=True)
    without = opened(conversation(side(ROBOT, [~B]), human), HUMAN, "persuasion", B)
    assert said(without, "challenge(b)").play(1).end is DialogueEnd.STALEMATE
    rule = Rule((A,), B, is_said=False)
    within = opened(conversation(side(ROBOT, [A, B], [rule]), human), ROBOT, "persuasion", B)
    within = said(within, "challenge(b)", "assert({a}, b)", "assert(a)")
    assert said(within, "reject(b)").play(1).end is DialogueEnd.DISAGREEMENT


def refused(who: Side, holds: Collection[Literal] = ()) -> Conversation:
    """A persuasion about b, of which one side, a person or a program, has refused the support a."""
    rule, other = Rule((A, C), B, is_said=False), HUMAN if who is ROBOT else ROBOT
    agents = {
        who: side(who, [A, C, B], [rule], is_person=who is HUMAN),
        other: side(other, holds, is_person=other is HUMAN),
    }
    now = opened(conversation(agents[ROBOT], agents[HUMAN]), who, "persuasion", B)
    return said(now, "challenge(b)", "assert({a, c}, b)", "assert(a)", "reject(b)")


@pytest.mark.parametrize("who", [ROBOT, HUMAN])
def test_a_no_to_a_support_is_the_end_unless_its_defender_asks_at_once_whether_the_opposite_holds(who: Side) -> None:
    now, other = refused(who), HUMAN if who is ROBOT else ROBOT
    assert now.play(1).end is DialogueEnd.DISAGREEMENT
    # To ask is for those who do not know; it takes a no to ask about what one has just said.
    assert all(now.opening(who, "information-seeking", topic) == () for topic in (A, ~A))
    assert all(now.opening(who, game, A, 1) == () for game in RULEBOOK.games)
    assert all(now.opening(other, game, ~A, 1) == () for game in RULEBOOK.games)
    assert now.opening(who, "persuasion", ~A, 1) == ()
    asks = opened(now, who, "information-seeking", ~A, 1)
    assert str(asks.record[-1].move) == "question(not a)"
    assert asks.play(1).end is None and asks.waits(1)
    # Anything else that is said leaves the no as it is.
    later = opened(now, who, "persuasion", C)
    assert later.opening(who, "information-seeking", ~A, 1) == ()


@pytest.mark.parametrize("who", [ROBOT, HUMAN])
def test_after_the_question_the_same_side_goes_on_and_a_second_no_has_the_other_name_and_stands(who: Side) -> None:
    now = said(opened(refused(who), who, "information-seeking", ~A, 1), "assert(U(a))", number=2)
    assert now.play(2).end is DialogueEnd.UNKNOWN and now.play(1).speaker is not who
    assert legal(now) == {"accept(a)", "reject(a)"}
    stands = said(now, "reject(a)")
    assert stands.play(1).end is DialogueEnd.DISAGREEMENT
    assert stands.opening(who, "information-seeking", ~A, 1) == ()
    goes_on = said(now, "accept(a)", "assert(c)")
    assert legal(goes_on) == {"accept(c)", "reject(c)"}
    assert said(goes_on, "accept(c)").play(1).end is DialogueEnd.AGREEMENT
    twice = said(goes_on, "reject(c)")
    assert twice.play(1).end is DialogueEnd.DISAGREEMENT
    assert twice.opening(who, "information-seeking", ~C, 1) == ()


@pytest.mark.parametrize("who", [ROBOT, HUMAN])
def test_who_accepts_the_opposite_of_its_support_has_nothing_to_defend_its_claim_with(who: Side) -> None:
    now = opened(refused(who, [~A]), who, "information-seeking", ~A, 1)
    now = said(now, "assert(not a)", "accept(not a)", number=2)
    assert [now.play(number).end for number in (1, 2)] == [DialogueEnd.DISAGREEMENT, DialogueEnd.AGREEMENT]
    assert ~A in now.agents[who].beliefs and A not in now.agents[who].beliefs


def test_who_has_no_answer_or_is_known_not_to_know_is_not_asked_about_a_no() -> None:
    # A program that holds the support itself has said no to the claim: there is nothing to ask about.
    assert refused(HUMAN, [A]).opening(HUMAN, "information-seeking", ~A, 1) == ()
    now = refused(ROBOT)
    robot = now.agents[ROBOT]
    now = now.with_agent(replace(robot, picture=robot.picture.gaining(Unknown(A.proposition))))
    assert now.opening(ROBOT, "information-seeking", ~A, 1) == ()


def test_a_refusal_that_is_being_questioned_stands_when_the_matter_is_past() -> None:
    now = opened(refused(ROBOT), ROBOT, "information-seeking", ~A, 1).withdraw(1)
    assert [now.play(number).end for number in (1, 2)] == [DialogueEnd.DISAGREEMENT, DialogueEnd.WITHDRAWN]


def test_a_refusal_inside_a_dialogue_that_has_ended_with_it_is_questioned_no_more() -> None:
    d = Literal(Fact("d"))
    robot = side(ROBOT, [A, C, B, d], [Rule((A,), B, is_said=False), Rule((A, C), d, is_said=False)])
    now = said(opened(conversation(robot, side(HUMAN, is_person=True)), ROBOT, "persuasion", B), "challenge(b)")
    now = opened(said(now, "assert({a}, b)"), ROBOT, "persuasion", d, 1)
    now = said(now, "challenge(d)", "assert({a, c}, d)", "assert(a)", "accept(a)", "assert(c)", "reject(d)", number=2)
    # That she holds a was all that was left to be said in the outer one.
    assert [play.end for play in now.plays] == [DialogueEnd.STALEMATE, DialogueEnd.DISAGREEMENT]
    assert now.refused is None


def test_an_argument_that_was_refused_as_a_whole_leaves_nothing_to_ask_about() -> None:
    now = conversation(side(ROBOT, [A, B], [Rule((A,), B, is_said=False)]), side(HUMAN, is_person=True))
    now = said(opened(now, ROBOT, "persuasion-in-brief", B), "challenge(b)", "assert({a}, b)", "reject(b)")
    assert now.refused is None
    assert now.opening(ROBOT, "information-seeking", ~A, 1) == ()


def test_the_last_support_implies_the_claim_and_none_before_it_does() -> None:
    rule = Rule((A, C), B, is_said=False)
    robot = side(ROBOT, [A, C, B], [rule])
    now = opened(conversation(robot, side(HUMAN, is_person=True)), ROBOT, "persuasion", B)
    now = said(now, "challenge(b)", "assert({a, c}, b)", "assert(a)", "accept(a)")
    assert now.play(1).end is None and B not in now.agents[ROBOT].picture
    now = said(now, "assert(c)", "accept(c)")
    assert now.play(1).end is DialogueEnd.AGREEMENT
    assert [str(each.move) for each in now.record if each.is_booked] == ["accept(b)"]
    assert B in now.agents[ROBOT].picture


def test_a_support_that_the_other_came_to_hold_elsewhere_is_not_said_and_may_leave_nothing_to_say() -> None:
    rule = Rule((A,), B, is_said=False)
    now = opened(conversation(side(ROBOT, [A, B], [rule]), side(HUMAN, is_person=True)), ROBOT, "persuasion", B)
    now = said(now, "challenge(b)", "assert({a}, b)")
    now = opened(now, ROBOT, "persuasion", A, parent=1)
    assert legal(now) == set() and now.waits(1)
    now = said(now, "accept(a)", number=2)
    assert now.play(1).end is DialogueEnd.STALEMATE


@pytest.mark.parametrize("is_person", [True, False])
def test_a_table_that_goes_in_circles_lets_nothing_be_said_twice(is_person: bool) -> None:
    opening = GameStage(GameRole.INITIATOR, (Reply("assert", Slot.TOPIC, "asked"),))
    asked = GameStage(GameRole.RESPONDENT, (Reply("challenge", Slot.CLAIM, "asked"),))
    circle = GameTable("circle", "literal", "opening", {"opening": opening, "asked": asked})
    rulebook = Rulebook(RULEBOOK.locutions, {"circle": circle})
    agents = {ROBOT: side(ROBOT, [B]), HUMAN: side(HUMAN, is_person=is_person)}
    now = said(opened(Conversation(rulebook, agents), ROBOT, "circle", B), "challenge(b)")
    assert now.play(1).end is DialogueEnd.STALEMATE


def test_who_can_argue_for_a_claim_does_not_reject_it() -> None:
    own, hers = Rule((C,), B, is_said=False), Rule((A,), B, is_said=False)
    for rules, answers in (([], {"accept(a)", "reject(b)"}), ([own], {"accept(a)"})):
        now = conversation(side(ROBOT, [C], rules), side(HUMAN, [A], [hers], is_person=True))
        now = said(opened(now, HUMAN, "persuasion", B), "challenge(b)", "assert({a}, b)", "assert(a)")
        assert legal(now) == answers


def test_a_person_says_no_support_that_the_robot_is_taken_to_hold() -> None:
    human = side(HUMAN, [A, C], [Rule((A, C), B, is_said=False)], hers=[A], is_person=True)
    now = said(opened(conversation(side(ROBOT), human), HUMAN, "persuasion", B), "challenge(b)")
    assert legal(now) == {"assert({a, c}, b)", "assert(c)"}


def test_of_one_s_own_rules_only_those_of_the_language_are_lent_to_the_other() -> None:
    for is_said in (True, False):
        robot, human = side(ROBOT, rules=[Rule((A,), B, is_said)], hers=[A]), side(HUMAN)
        at = Utterer(robot, human, lambda _: False, RULEBOOK.committing)
        assert CONDITIONS["thought to be argued"].holds(at, B) is not is_said


def test_who_holds_the_premises_of_an_accepted_rule_has_learnt_its_conclusion_and_nobody_else() -> None:
    for held in ([A], []):
        now = conversation(side(ROBOT, held), side(HUMAN, [A], [IMPLIES]))
        now = said(opened(now, HUMAN, "inquiry", IMPLIES), f"accept({IMPLIES})")
        robot, human = now.agents[ROBOT], now.agents[HUMAN]
        assert all(IMPLIES in each for each in (robot.beliefs, human.beliefs, robot.picture, human.picture))
        assert (B in robot.beliefs) is bool(held)
        assert B in human.beliefs and B in robot.picture


def test_a_side_that_may_be_able_to_tell_is_asked_and_after_a_u_is_not_asked_again() -> None:
    robot, human = side(ROBOT, [A], [IMPLIES]), side(HUMAN, is_person=True)
    now = Conversation(RULEBOOK, {ROBOT: robot, HUMAN: human}, able=lambda who, _: who is HUMAN)
    (opening,) = now.openings(ROBOT, B.proposition)
    assert str(opening.move) == "question(b)"
    now = said(now.open(ROBOT, opening), "assert(U(b))")
    assert Unknown(B.proposition) in now.agents[ROBOT].picture
    assert now.opening(ROBOT, "information-seeking", B) == ()


def test_a_reply_is_used_up_by_a_dialogue_that_failed_not_by_one_that_was_agreed() -> None:
    human = side(HUMAN, is_person=True)
    now = said(opened(conversation(side(ROBOT, [B]), human), ROBOT, "persuasion", B), "accept(b)")
    # She changes her mind, can give no reason, and may be persuaded as before.
    now = said(opened(now, HUMAN, "persuasion", ~B), "challenge(not b)", number=2)
    now = said(opened(now, ROBOT, "persuasion", B), "challenge(b)", "assert({b}, b)", "reject(b)", number=3)
    now = opened(now, ROBOT, "persuasion", B)
    assert legal(now, 4) == {"accept(b)", "assert(not b)"}


def test_conversations_are_the_same_whatever_order_python_s_sets_have() -> None:
    def printed(seed: str) -> str:
        command = [sys.executable, "-m", "tests.thbridge.dialogue.games.random_talk", "60"]
        environment = {**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT)}
        return subprocess.run(command, env=environment, cwd=ROOT, check=True, capture_output=True, text=True).stdout

    first = printed("1")
    assert len(first.splitlines()) > 500
    assert first == printed("2")
