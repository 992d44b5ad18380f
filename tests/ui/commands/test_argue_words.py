"""Reasons and discussions, as people read them."""

import re

import pytest
from hypothesis import given

from tests.support.dialogue.random_frameworks import chain, frameworks
from thbridge.dialogue.argumentation.discussion import discuss
from thbridge.dialogue.argumentation.framework import ArgumentationFramework
from thbridge.dialogue.argumentation.semantics import Semantics, extensions
from ui.commands.argue.words import discussion_in_words, grounded_label, membership_in_words

CIRCLE = ArgumentationFramework.of("abc", [("a", "b"), ("b", "c"), ("c", "a")])
NIXON = ArgumentationFramework.of("abcd", [("b", "a"), ("c", "b"), ("c", "d"), ("d", "c")])
SELF = ArgumentationFramework.of("ab", [("a", "a"), ("a", "b")])
TWICE = ArgumentationFramework.of("abcd", [("b", "a"), ("c", "a"), ("d", "b"), ("d", "c")])
UNDECIDED_END = "The opponent wins: {} need not be accepted, and need not be rejected."


@pytest.mark.parametrize(
    ("framework", "name", "told"),
    [
        (
            chain(3),
            "a2",
            [
                "Proponent: a2 must be accepted.",
                "Opponent:  But a1 attacks a2.",
                "Proponent: a0 attacks a1, and must be accepted.",
                "Opponent:  Nothing attacks a0. I concede a0.",
                "Opponent:  a0 attacks a1. I take a1 back.",
                "Opponent:  I have taken back every attacker of a2. I concede a2.",
                "The proponent wins: a2 must be accepted.",
            ],
        ),
        (
            chain(2),
            "a1",
            [
                "Proponent: a1 must be accepted.",
                "Opponent:  But a0 attacks a1.",
                "Proponent: Nothing attacks a0. I have no answer.",
                "The opponent wins: a1 must be rejected.",
            ],
        ),
        (
            CIRCLE,
            "a",
            [
                "Proponent: a must be accepted.",
                "Opponent:  But c attacks a.",
                "Proponent: b attacks c, and must be accepted.",
                "Opponent:  But a attacks b.",
                "These attacks form a cycle, so they decide nothing: a attacks b, b attacks c, c attacks a.",
                UNDECIDED_END.format("a"),
            ],
        ),
        (
            SELF,
            "b",
            [
                "Proponent: b must be accepted.",
                "Opponent:  But a attacks b.",
                "Proponent: a attacks itself, and must be accepted.",
                "An argument that attacks itself cannot be accepted.",
                UNDECIDED_END.format("b"),
            ],
        ),
    ],
)
def test_a_discussion_says_who_attacks_whom_and_how_it_ends(
    framework: ArgumentationFramework, name: str, told: list[str]
) -> None:
    assert list(discussion_in_words(framework, discuss(framework, name))) == told


@pytest.mark.parametrize(
    ("framework", "semantics", "name", "told"),
    [
        (chain(1), "GR", "a0", ["a0 is in the grounded extension: nothing attacks it."]),
        (chain(3), "GR", "a2", ["a2 is in the grounded extension: a1 attacks it, but a0 attacks a1."]),
        (TWICE, "GR", "a", ["a is in the grounded extension: each of its attackers is attacked (b by d, c by d)."]),
        (
            NIXON,
            "PR",
            "a",
            [
                "a is in the preferred extension {a, c}: b attacks it, but c attacks b.",
                "a is not in the preferred extension {b, d}: b attacks it, and is in the extension.",
            ],
        ),
        (
            CIRCLE,
            "CO",
            "a",
            [
                "a is not in the complete extension: c attacks it."
                " Nothing in the extension attacks c or a, so both are undecided."
            ],
        ),
        (
            SELF,
            "GR",
            "a",
            [
                "a is not in the grounded extension: it attacks itself."
                " Nothing in the extension attacks it, so it is undecided."
            ],
        ),
        (CIRCLE, "ST", "a", []),
    ],
)
def test_a_reason_says_what_attacks_and_what_answers(
    framework: ArgumentationFramework, semantics: str, name: str, told: list[str]
) -> None:
    found = extensions(framework, Semantics(semantics))
    assert list(membership_in_words(framework, Semantics(semantics), found, name)) == told


@given(framework=frameworks())
def test_nothing_is_said_that_is_not_so(framework: ArgumentationFramework) -> None:
    ends = {"in": "must be accepted.", "out": "must be rejected.", "undecided": "need not be rejected."}
    for name in framework.arguments:
        lines = list(discussion_in_words(framework, discuss(framework, name)))
        assert lines[-1].endswith(ends[grounded_label(framework, name)])
        for semantics in Semantics:
            lines += membership_in_words(framework, semantics, extensions(framework, semantics), name)
        told = "\n".join(lines)
        attacks = {
            *re.findall(r"(a\d+) attacks (a\d+)", told),
            *((one, one) for one in re.findall(r"(a\d+) attacks itself", told)),
            *((attacker, target) for target, attacker in re.findall(r"(a\d+) by (a\d+)", told)),
        }
        assert attacks <= framework.attacks
        for unattacked in re.findall(r"Nothing attacks (a\d+)", told):
            assert not framework.attackers[framework.index[unattacked]]
