"""Randomly chosen topics of dialogues, and engines that argue about them."""

from dataclasses import dataclass

from hypothesis import assume
from hypothesis import strategies as st

from tests.support.dialogue.random_facts import what_facts, where_facts
from thbridge.dialogue.arguing import ArguingEngine
from thbridge.dialogue.arguing_moves import MOST_CHOICES
from thbridge.dialogue.conditions import DialogueCondition, Manner
from thbridge.dialogue.engine import DialogueStep
from thbridge.dialogue.games.strategies import Attitude
from thbridge.dialogue.moves import Dialogue, DialogueTopic, Leave, Move, Scenario, Speaker
from thbridge.dialogue.propositions import NextRoom
from thbridge.dialogue.robot_arguments import WhatFacts, WhereFacts, where
from thbridge.files.game_files import read_rulebook
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_tour import PlanValue

RULEBOOK = read_rulebook()
ARGUING = [DialogueCondition.COLLABORATOR, DialogueCondition.ADVISER, DialogueCondition.AUTONOMOUS]


@dataclass(frozen=True)
class FormalPhrasing:
    """Phrasing that writes moves in the formal notation of the paper."""

    names_energy: bool = True

    def without_energy(self) -> "FormalPhrasing":
        return self

    def say(self, dialogue: Dialogue, move: Move, speaker: Speaker) -> str:
        return str(move)

    def authored(self, dialogue: Dialogue, move: Move) -> None:
        return None


def formal_engine(manner: Manner) -> ArguingEngine:
    return ArguingEngine(RULEBOOK, {None: manner}, FormalPhrasing(), seed=3)


manners = st.builds(
    Manner,
    condition=st.sampled_from(ARGUING),
    attitude=st.sampled_from(Attitude),
    persistence=st.integers(0, 3),
    talkative=st.booleans(),
    gives_reasons=st.booleans(),
    misheard=st.sampled_from([0.0, 0.0, 0.5]),
)
MOST_TURNS = 60


@st.composite
def topics(draw: st.DrawFn) -> DialogueTopic:
    facts: WhereFacts | WhatFacts = draw(st.one_of(where_facts(), what_facts()))
    if isinstance(facts, WhereFacts):
        return draw(topics_of(facts))
    scenario = draw(st.sampled_from([Scenario.TAKE_PICTURE, Scenario.TAKE_TREASURE]))
    return DialogueTopic(scenario, 0, facts.room, facts.picture_cost, facts.energy, facts=facts)


@st.composite
def topics_of(draw: st.DrawFn, facts: WhereFacts) -> DialogueTopic:
    assume(facts.values)
    scenario = draw(st.sampled_from([Scenario.SPECIFIC_ROOM, Scenario.DONT_KNOW]))
    opener = draw(st.sampled_from(Speaker)) if scenario is Scenario.DONT_KNOW else Speaker.PERSON
    decision = where(facts).decision
    assume(decision is not None)
    room = draw(st.sampled_from(sorted(facts.values)))
    if scenario is not Scenario.SPECIFIC_ROOM and decision is not None and isinstance(decision.proposition, NextRoom):
        room = decision.proposition.room
    return DialogueTopic(scenario, 0, room, facts.costs[room], facts.energy, facts=facts, opener=opener)


def play_to_the_end(talker: ArguingEngine, step: DialogueStep, draw: st.DataObject) -> DialogueStep:
    """Make random choices until the dialogue ends; after MOST_TURNS turns, leave it as soon as that is offered."""
    while step.outcome is None:
        choices = talker.choices(step.dialogue)
        assert 0 < len(choices) <= MOST_CHOICES
        assert len({choice.text for choice in choices}) == len(choices)
        assert talker.choices(step.dialogue, Speaker.ROBOT) == ()
        last = len(step.dialogue.turns) > MOST_TURNS and choices[-1].move == Leave()
        step = talker.move(step.dialogue, Leave() if last else draw.draw(st.sampled_from(choices)).move)
    return step


FACTS = WhereFacts(
    robot=0,
    here=Room(0),
    energy=500.0,
    costs={Room(1): 50.0, Room(2): 80.0, Room(3): 100.0},
    left=(Room(1), Room(2), Room(3)),
    values={Room(1): PlanValue(3, 300.0), Room(2): PlanValue(3, 250.0), Room(3): PlanValue(2, 200.0)},
)


def answered(talker: ArguingEngine, step: DialogueStep, text: str) -> DialogueStep:
    move = next(choice.move for choice in talker.choices(step.dialogue) if choice.text == text)
    return talker.move(step.dialogue, move)
