"""Random sides of a conversation over a handful of facts, and random talk between them, printed line by line."""

import random
import sys
from dataclasses import dataclass

from tests.thbridge.dialogue.games.judge import Fact, Judge, Party
from thbridge.dialogue.argumentation.arguments import Belief
from thbridge.dialogue.argumentation.beliefs import Beliefs, Origin, Source
from thbridge.dialogue.argumentation.cases import Side
from thbridge.dialogue.argumentation.propositions import Conjunction, Literal, Proposition, Rule
from thbridge.dialogue.games.agents import Agent, Picture
from thbridge.dialogue.games.contents import Unknown
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.tables import Rulebook
from thbridge.files.game_files import read_rulebook

FACTS = tuple(Fact(name) for name in ("a1", "a2", "b", "c", "d"))
LITERALS = tuple(Literal(fact, holds) for fact in FACTS for holds in (True, False))
BOTH = Conjunction((LITERALS[0], LITERALS[4]))
PROPOSITIONS: tuple[Proposition, ...] = (*FACTS, BOTH)
CLAIMS = (*LITERALS, Literal(BOTH), ~Literal(BOTH))
GAMES = ("persuasion", "persuasion-in-brief", "information-seeking", "information-seeking-in-brief", "inquiry")


@dataclass(frozen=True)
class Start:
    """How a conversation begins, for the engine and for its judge."""

    conversation: Conversation
    judge: Judge


def random_start(rng: random.Random, rulebook: Rulebook) -> Start:
    """Two sides with few beliefs, some of them inconsistent, and with pictures of each other that may be wrong."""
    language = [random_rule(rng, is_said=False) for _ in range(rng.randrange(2))]
    agents = {side: _random_agent(rng, side, language) for side in Side}
    able = {side: frozenset(rng.sample(FACTS, rng.randrange(4))) for side in Side}
    parties = {
        side: Party.of(agent.beliefs, agent.picture, is_person=agent.is_person) for side, agent in agents.items()
    }
    conversation = Conversation(rulebook, agents, able=lambda side, what: what in able[side])
    return Start(conversation, Judge(parties, able))


def random_rule(rng: random.Random, *, is_said: bool) -> Rule:
    premises = tuple(rng.sample(LITERALS, rng.choice([1, 1, 2])))
    return Rule(premises, rng.choice([each for each in CLAIMS if each not in premises]), is_said)


def random_topic(rng: random.Random, now: Conversation) -> Belief:
    rules = [random_rule(rng, is_said=True), *(rule for agent in now.agents.values() for rule in agent.beliefs.rules)]
    # What follows from two rules, one after the other, is a rule, too.
    rules += [
        Rule(one.premises, other.conclusion) for one in rules for other in rules if one.conclusion in other.premises
    ]
    if rng.random() < 0.3:
        return rng.choice(rules)
    # Much of the talk is about what somebody can argue for.
    return rng.choice(rules).conclusion if rng.random() < 0.6 else rng.choice(CLAIMS)


def _random_agent(rng: random.Random, side: Side, language: list[Rule]) -> Agent:
    rules = [*language, *(random_rule(rng, is_said=rng.random() < 0.5) for _ in range(rng.randrange(1, 4)))]
    if rng.random() < 0.5:
        start, middle, end = (Literal(fact, rng.random() < 0.5) for fact in rng.sample(FACTS, 3))
        also = [rng.choice(LITERALS)] if rng.random() < 0.3 else []
        rules += [Rule((start,), middle), Rule((middle, *(each for each in also if each != middle)), end)]
    held = [rng.choice(CLAIMS) for _ in range(rng.randrange(3))]
    for rule in rules:
        # Arguments of several steps are rare among beliefs that have nothing to do with each other.
        held += [*(rule.premises if rng.random() < 0.8 else ()), *([rule.conclusion] if rng.random() < 0.3 else [])]
    sources = (Source.SENSED, Source.SENSED, Source.DECIDED)
    origins = {part: Origin(rng.choice(sources)) for each in held for part in (each, *each.parts)}
    picture = Picture()
    for _ in range(rng.randrange(3)):
        picture = picture.gaining(Unknown(rng.choice(FACTS)) if rng.random() < 0.2 else rng.choice(CLAIMS))
    return Agent(side, Beliefs(origins, tuple(dict.fromkeys(rules))), rng.random() < 0.5, picture)


def talk(seed: int, rulebook: Rulebook) -> None:
    """Print what is said, and what might have been, in a random conversation."""
    rng = random.Random(seed)
    now = random_start(rng, rulebook).conversation
    for _ in range(30):
        waiting = [play for play in now.open_plays if now.legal(play.number)]
        if waiting and rng.random() < 0.7:
            play = rng.choice(waiting)
            legal = now.legal(play.number)
            print(play.number, *legal, sep=" | ")
            now = now.say(play.number, rng.choice(legal))
        else:
            side, parent = rng.choice(list(Side)), rng.choice([None, *(play.number for play in waiting)])
            for opening in now.opening(side, rng.choice(GAMES), random_topic(rng, now), parent):
                now = now.open(side, opening, parent=parent)
    print(*(f"{said.dialogue} {said.side} {said.move} {said.after}" for said in now.record), sep="\n")


if __name__ == "__main__":
    SHIPPED = read_rulebook()
    for number in range(int(sys.argv[1])):
        talk(number, SHIPPED)
