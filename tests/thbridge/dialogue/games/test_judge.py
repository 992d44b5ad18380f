"""The judge hears what is wrong: of engines that break one rule each, it disagrees with every one."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace

import pytest

from tests.thbridge.dialogue.games import dialogue_machine as machine
from thbridge.dialogue.argumentation import arguments, beliefs
from thbridge.dialogue.argumentation.arguments import Argument, Belief, arguments_for
from thbridge.dialogue.argumentation.propositions import Literal, Rule
from thbridge.dialogue.games import agents, control, dialogue_game, locutions
from thbridge.dialogue.games.agents import Agent
from thbridge.dialogue.games.contents import ContentKind
from thbridge.dialogue.games.control import Conversation
from thbridge.dialogue.games.tables import DialogueEnd, Rulebook

Break = Callable[[pytest.MonkeyPatch], None]
MOST_TALKS = 400


def _locutions(*changed: tuple[str, str | None, dict[str, tuple[str, ...]] | None]) -> Break:
    """Change, or with None take away, the forms with rules of some locutions and slots."""
    forms = {(each.name, each.content, each.of): each for each in machine.RULEBOOK.locutions}
    for name, of, values in changed:
        key = (name, ContentKind.RULE, of)
        assert key in forms
        if values is None:
            del forms[key]
        else:
            forms[key] = replace(forms[key], **values)
    rulebook = Rulebook(tuple(forms.values()), machine.RULEBOOK.games)
    return lambda patch: patch.setattr(machine, "RULEBOOK", rulebook)


def _set(place: object, name: str, value: object) -> Break:
    return lambda patch: patch.setattr(place, name, value)


def _arguing_for_rules(supports: Callable[[Rule, Sequence[Argument]], Collection[frozenset[Belief]]]) -> Break:
    """Change what supports rules."""

    def argue(conclusion: Belief, *rest: object) -> tuple[Argument, ...]:
        found = arguments_for(conclusion, *rest)  # type: ignore[arg-type]
        if isinstance(conclusion, Literal):
            return found
        return tuple(Argument(support, conclusion) for support in sorted(supports(conclusion, found), key=str))

    def patched(patch: pytest.MonkeyPatch) -> None:
        for module in (beliefs, agents):
            patch.setattr(module, "arguments_for", argue)

    return patched


def _premises_as_support(defender: Agent, claim: Belief) -> tuple[Argument, ...]:
    if isinstance(claim, Rule):
        return (Argument(frozenset(claim.premises), claim.conclusion),)
    return defender.beliefs.arguments(claim)


def _concluding_blindly(agent: Agent, rule: Rule, at: float) -> Agent:
    concluded = _WITH_RULE(agent, rule, at)
    return replace(concluded, picture=concluded.picture.gaining(rule.conclusion))


def _same_topic_and_game(self: Conversation, game: str, topic: Belief) -> bool:
    return any((play.topic, play.game.name) == (topic, game) for play in self.open_plays)


def _used_up_outside(self: Conversation, topic: Belief, initiator: object) -> frozenset[object]:
    inside = {play.moves[0] for play in self.plays if play.parent is not None}
    return frozenset(pair for pair in _USED_UP(self, topic, initiator) if (initiator, pair[0]) not in inside)  # type: ignore[arg-type]


def _used_up_by_agreement(self: Conversation, topic: Belief, initiator: object) -> frozenset[object]:
    agreed = [play for play in self.plays if (play.topic, play.initiator) == (topic, initiator)]
    agreed = [play for play in agreed if play.end is DialogueEnd.AGREEMENT and len(play.moves) > 2]
    return _USED_UP(self, topic, initiator) | {(play.moves[0][1], play.moves[1][1]) for play in agreed}  # type: ignore[arg-type]


_WITH_RULE = locutions._with_rule
_USED_UP = Conversation._used_up

BROKEN: dict[str, Break] = {
    # What supports a rule.
    "its premises are the support of a rule": _set(dialogue_game, "_arguments", _premises_as_support),
    "premises are part of the support of a rule": _arguing_for_rules(
        lambda rule, found: [argument.support | {*rule.premises} for argument in found]
    ),
    "what derives the conclusion supports the rule, nothing is granted": _set(
        arguments, "_derivation", lambda belief: (frozenset(), getattr(belief, "conclusion", belief))
    ),
    "nothing but itself supports a rule": _arguing_for_rules(
        lambda rule, found: [argument.support for argument in found if rule in argument.support]
    ),
    "a rule that is held does not support itself": _arguing_for_rules(
        lambda rule, found: [argument.support for argument in found if rule not in argument.support]
    ),
    "only one argument for a rule is seen": _arguing_for_rules(
        lambda _, found: [argument.support for argument in found[:1]]
    ),
    # What is said of rules.
    "only a rule that is held is proposed": _locutions(
        ("propose", None, {"before": ("held", "premises held", "consequence open")})
    ),
    "a rule is proposed without its premises": _locutions(
        ("propose", None, {"before": ("argued", "consequence open")})
    ),
    "a rule is proposed though nothing derives it": _locutions(
        ("propose", None, {"before": ("premises held", "consequence open")})
    ),
    "support is proposed like a topic": _locutions(("propose", "support", None)),
    "support that is a rule is not shown to be held": _locutions(
        ("propose", "support", {"after": ("shown to be argued",)})
    ),
    "a proposal does not show its premises": _locutions(
        ("propose", None, {"after": ("claimed", "shown to be argued")})
    ),
    "a rule is rejected by those who argue for it": _locutions(("reject", None, {"before": ("said", "not held")})),
    "a rule that is held is challenged": _locutions(("challenge", None, {"before": ("said", "thought to be argued")})),
    "an accepted rule is believed, and nothing concluded": _locutions(
        ("accept", None, {"after": ("believed", "shown")})
    ),
    "who accepts a rule concludes without premises": _set(locutions, "_with_rule", _concluding_blindly),
    # Dialogues inside others.
    "a dialogue is opened on the opposite of what another is about": _set(control, "matter_of", lambda topic: topic),
    "a rule is another matter than its conclusion": _set(
        control, "matter_of", lambda topic: topic if isinstance(topic, Rule) else topic.proposition
    ),
    "one matter is talked over in two dialogues": _set(control, "_is_talked_over", lambda *_: False),
    "inner dialogues are opened again and again": _set(control, "_said_inside", lambda *_: frozenset()),
    "no reply is used up": _set(Conversation, "_used_up", lambda *_: frozenset()),
    "a reply inside another dialogue is not used up": _set(Conversation, "_used_up", _used_up_outside),
    "a reply that led to agreement is used up": _set(Conversation, "_used_up", _used_up_by_agreement),
}


QUICK = {"its premises are the support of a rule", "a dialogue is opened on the opposite of what another is about"}
"""Those that are found at once; the engine was broken so before."""


def heard(talks: int) -> int | None:
    """Number of the first random talk in which engine and judge differ, or None."""
    for seed in range(talks):
        try:
            machine.talk(seed)
        except (Exception, pytest.fail.Exception):
            return seed
    return None


@pytest.mark.parametrize(
    "broken", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in BROKEN]
)
def test_an_engine_that_breaks_a_rule_is_found_out(broken: str, monkeypatch: pytest.MonkeyPatch) -> None:
    BROKEN[broken](monkeypatch)
    assert heard(MOST_TALKS) is not None
