"""Portraits of conversations: what researchers see of a robot's mind."""

import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.dialogue.argued_topics import FACTS, answered, formal_engine, manners, topics
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Literal
from thbridge.dialogue.conditions import Manner
from thbridge.dialogue.engine import DialogueStep
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.moves import DialogueTopic, Scenario
from thbridge.dialogue.portrait import (
    MOST_ARGUMENTS,
    DialoguePortrait,
    ObjectionsToClaim,
    portray,
    read_portrait,
)
from thbridge.dialogue.propositions import Decided, NextRoom, Objected
from thbridge.dialogue.rule_examples import BROWN_BOTTLE, rules_as_topics
from thbridge.files.game_files import read_rulebook
from thbridge.hunt.rooms import Room

WANTED = "wanted(next(Robot1, Room1))"
COMPARED = ("less_than(250, 300)", "plan(Robot1, Room1, 3, 300)", "plan(Robot1, Room2, 3, 250)")


def conversation_of(step: DialogueStep) -> Conversation:
    assert step.dialogue.conversation is not None
    return step.dialogue.conversation


@given(topics(), manners, st.data())
def test_a_portrait_tells_what_is_believed_and_said_and_can_be_read_again(
    topic: DialogueTopic, manner: Manner, draw: st.DataObject
) -> None:
    talker: ArguingEngine = formal_engine(manner)
    step = talker.open(1, topic)
    for _ in range(draw.draw(st.integers(0, 6))):
        if step.outcome is None:
            step = talker.move(step.dialogue, draw.draw(st.sampled_from(talker.choices(step.dialogue))).move)
    conversation = conversation_of(step)
    portrait = portray(conversation)
    assert read_portrait(portrait.json()) == portrait
    robot, person = conversation.agents[Side.ROBOT], conversation.agents[Side.HUMAN]
    assert {belief.literal for belief in portrait.sigma} == set(map(str, robot.beliefs.origins))
    assert portrait.held == tuple(sorted(map(str, robot.picture.held)))
    assert portrait.robot_store == tuple(map(str, robot.store))
    assert portrait.human_store == tuple(map(str, person.store))
    assert [game.number for game in portrait.games] == [play.number for play in conversation.plays]
    assert len(portrait.arguments) <= MOST_ARGUMENTS
    # Nothing argues for itself but what the robot believes already, and facts of the person's that no rule concludes.
    claims = {rule.conclusion.proposition for agent in (robot, person) for rule in agent.beliefs.rules}
    held = {belief.literal for belief in portrait.sigma}
    held |= {str(literal) for literal in robot.picture.held if literal.proposition not in claims}
    assert {each.conclusion for each in portrait.arguments if each.conclusion in each.support} <= held
    # What stands is attacked by nothing that stands.
    assert not {(one, other) for one, other in portrait.attacks if {one, other} <= set(portrait.grounded)}


def test_arguments_for_a_rule_are_in_the_portrait_of_a_conversation_about_it() -> None:
    now = rules_as_topics(read_rulebook())[0].start
    (opening,) = now.openings(Side.ROBOT, BROWN_BOTTLE)
    portrait = portray(now.open(Side.ROBOT, opening))
    brown, bottle, treasure = (
        "color_found(image3, brown)",
        "in_image(bottle, image3)",
        "treasure_in(brown bottle, Room2)",
    )
    (argument,) = [each for each in portrait.arguments if each.conclusion == f"{brown} -> {treasure}"]
    assert argument.support == (f"{brown} -> {bottle}", f"{bottle} -> {treasure}")
    assert argument.sides == ("robot",) and portrait.arguments.index(argument) in portrait.grounded
    assert brown not in portrait.held


def test_a_wish_is_an_argument_of_the_person_that_does_not_stand_against_a_better_one() -> None:
    talker = formal_engine(Manner())
    step = talker.open(1, DialogueTopic(Scenario.SPECIFIC_ROOM, 0, Room(1), 50.0, 500.0, facts=FACTS))
    for text in (
        "challenge(not next(Robot1, Room1))",
        "reject(not next(Robot1, Room1))",
        "assert(next(Robot1, Room1))",
        f"assert({WANTED})",
    ):
        step = answered(talker, step, text)
    portrait = portray(conversation_of(step))
    held = {(each.support, each.conclusion): each.sides for each in portrait.arguments}
    wish, better = ((WANTED,), "next(Robot1, Room1)"), (COMPARED, "not next(Robot1, Room1)")
    assert held[wish] == ("human",) and held[better] == ("robot",)
    places = [(each.support, each.conclusion) for each in portrait.arguments]
    assert (places.index(better), places.index(wish)) in portrait.attacks
    assert places.index(better) in portrait.grounded and places.index(wish) not in portrait.grounded
    assert [(game.topic, game.opener, game.end) for game in portrait.games] == [
        ("next(Robot1, Room1)", "human", "disagreement")
    ] * 2


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        "nothing",
        json.dumps({**json.loads(DialoguePortrait().json()), "attacks": [[0, 1]]}),
        json.dumps({**json.loads(DialoguePortrait().json()), "sigma": [["a", "sensed"]]}),
        json.dumps({**json.loads(DialoguePortrait().json()), "games": [{"number": 1e400}]}),
    ],
)
def test_other_texts_are_no_portraits(text: str) -> None:
    with pytest.raises(ValueError, match="no portrait of a conversation"):
        read_portrait(text)


def test_an_objection_attacks_the_claim_until_the_decision_defends_it() -> None:
    talker = formal_engine(Manner())
    step = talker.open(1, DialogueTopic(Scenario.SPECIFIC_ROOM, 0, Room(1), 50.0, 500.0, facts=FACTS))
    conversation, claim = conversation_of(step), Literal(NextRoom(0, Room(2)))
    premise = Literal(Objected("namer", "too_far"))

    def standing(objections: ObjectionsToClaim | None) -> dict[str, bool]:
        portrait = portray(conversation, objections)
        assert read_portrait(portrait.json()) == portrait
        names = ["; ".join(each.support) + ": " + each.conclusion for each in portrait.arguments]
        return {name: at in portrait.grounded for at, name in enumerate(names)}

    raised = ObjectionsToClaim(claim, (("namer", premise),))
    alone, objected = standing(None), standing(raised)
    decided = standing(replace(raised, decided=("driver", Literal(Decided("driver")))))
    own = [name for name in alone if name.endswith(f": {claim}")]
    assert own and all(alone[name] for name in own)
    objection = f"objected(namer, too_far): not {claim}"
    assert objected[objection] is False and not any(objected[name] for name in own)
    assert decided[objection] is False and all(decided[name] for name in own)
    assert decided[f"decided(driver): {claim}"]
