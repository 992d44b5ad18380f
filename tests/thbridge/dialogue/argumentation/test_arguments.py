"""Arguments from beliefs, with the beliefs of the worked example of Sklar and Azhar (2015)."""

from dataclasses import dataclass
from itertools import combinations

from hypothesis import given
from hypothesis import strategies as st

from tests.support.dialogue.derivations import derives
from thbridge.dialogue.argumentation.arguments import (
    Argument,
    Belief,
    arguments_for,
    c_supports,
    framework_of,
    p_supports,
    rebuts,
    undermines,
)
from thbridge.dialogue.argumentation.propositions import Literal, Proposition, Rule, consistent, opposed
from thbridge.dialogue.argumentation.semantics import grounded
from thbridge.dialogue.propositions import EnergyCost, EnergyLevel, LessThan, Selected, VisitOrder
from thbridge.hunt.rooms import Room

LEVEL = Literal(EnergyLevel(1000.0))
COST = Literal(EnergyCost(Room(4), Room(3), 100.0))
BELOW = Literal(LessThan((100.0,), 1000.0))
CHOSEN = Literal(Selected(Room(3)))
AFFORDABLE = Rule((LEVEL, COST, BELOW), CHOSEN, is_said=False)


@dataclass(frozen=True, slots=True)
class Fact(Proposition):
    name: str

    def __str__(self) -> str:
        return self.name


def fact(name: str) -> Literal:
    return Literal(Fact(name))


def is_no_decision(literal: Literal) -> bool:
    return not isinstance(literal.proposition, Selected | VisitOrder)


def test_the_robot_s_argument_for_a_room_is_its_level_the_cost_and_that_one_is_below_the_other() -> None:
    (argument,) = arguments_for(CHOSEN, [LEVEL, COST, BELOW, CHOSEN], [AFFORDABLE], is_no_decision)
    assert argument.support == {LEVEL, COST, BELOW}
    assert {str(each) for each in argument.support} == {
        "current_energy_level(1000)",
        "energy_cost(Room4, Room3, 100)",
        "less_than(100, 1000)",
    }
    assert arguments_for(CHOSEN, [LEVEL, COST, CHOSEN], [AFFORDABLE], is_no_decision) == ()


def test_orders_exclude_each_other_by_place_and_by_room() -> None:
    first = Literal(VisitOrder(1, Room(1)))
    assert opposed(first, Literal(VisitOrder(1, Room(3))))
    assert opposed(first, Literal(VisitOrder(2, Room(1))))
    assert not opposed(first, Literal(VisitOrder(2, Room(3))))
    assert opposed(first, ~first)
    assert not opposed(~first, Literal(VisitOrder(1, Room(3))))


def test_attacks_and_supports() -> None:
    a, b, c = fact("a"), fact("b"), fact("c")
    for_b = Argument(frozenset([a]), b)
    against_b = Argument(frozenset([c]), ~b)
    against_a = Argument(frozenset([c]), ~a)
    assert rebuts(for_b, against_b)
    assert rebuts(against_b, for_b)
    assert undermines(against_a, for_b)
    assert not undermines(for_b, against_a)
    assert p_supports(Argument(frozenset([c]), a), for_b)
    assert c_supports(for_b, Argument(frozenset([c]), b))
    assert not c_supports(for_b, for_b)


def test_an_attack_on_what_is_preferred_fails() -> None:
    a, b = fact("a"), fact("b")
    seen, heard = Argument(frozenset([a]), b), Argument(frozenset([~a]), ~b)
    assert grounded(framework_of([seen, heard])) == frozenset()
    assert grounded(framework_of([seen, heard], lambda one, _: one == seen)) == {str(seen)}


def test_what_argues_in_a_circle_is_no_argument() -> None:
    a, b = fact("a"), fact("b")
    assert arguments_for(a, [], [Rule((b,), a), Rule((a,), b)]) == ()


def test_what_follows_by_rules_of_the_language_must_be_consistent_too() -> None:
    a, b, c, d = fact("a"), fact("b"), fact("c"), fact("d")
    rules = [Rule((a,), b, is_said=False), Rule((b, d), c, is_said=False)]
    assert [argument.support for argument in arguments_for(c, [a, d], rules)] == [{a, d}]
    assert arguments_for(c, [a, d], [*rules[:1], Rule((b, d), ~a), Rule((~a,), c)]) == ()


def test_what_derives_a_rule_with_its_premises_granted_supports_it_and_they_do_not() -> None:
    a, b, c, d = fact("a"), fact("b"), fact("c"), fact("d")
    first, second, both, whole = Rule((a,), c), Rule((c,), b), Rule((a, d), b), Rule((a,), b)

    def supports(literals: list[Literal], rules: list[Rule], conclusion: Rule = whole) -> list[frozenset[Belief]]:
        found = arguments_for(conclusion, literals, rules)
        assert all(argument.conclusion == conclusion for argument in found)
        return [argument.support for argument in found]

    assert supports([a], []) == supports([a, c], [first]) == []
    assert supports([], [first, second]) == supports([a], [first, second]) == [{first, second}]
    assert supports([a, d], [both]) == [{d, both}]
    assert supports([], [both], Rule((d, a), b)) == [{both}]
    # A rule that is held supports itself, as an observation does; one of the language rests on nothing.
    assert supports([], [whole]) == [{whole}]
    assert supports([], [Rule((a,), b, is_said=False)]) == [frozenset()]
    # From what cannot hold together with its premises a rule does not follow.
    assert supports([], [Rule((a,), ~a), Rule((~a,), b)]) == []
    assert supports([], [Rule((a,), d), Rule((d,), b)], Rule((a, ~d), b)) == []


def test_a_rule_is_attacked_in_what_it_rests_on_alone() -> None:
    a, b, c, d = fact("a"), fact("b"), fact("c"), fact("d")
    for_rule = Argument(frozenset([d, Rule((a, d), b)]), Rule((a,), b))
    assert undermines(Argument(frozenset([c]), ~d), for_rule)
    for conclusion in (~b, ~a, Rule((a,), ~b)):
        other = Argument(frozenset([c]), conclusion)
        assert not rebuts(other, for_rule) and not rebuts(for_rule, other) and not undermines(for_rule, other)
    assert p_supports(for_rule, Argument(frozenset([a, Rule((a,), b)]), b))


NAMES = [fact(name) for name in "abcd"]
LITERALS = st.sampled_from([*NAMES, *(~name for name in NAMES)])
PREMISES = st.lists(LITERALS, min_size=1, max_size=2, unique=True).map(tuple)
RULES = st.builds(Rule, PREMISES, LITERALS, st.just(True))


@given(
    literals=st.frozensets(LITERALS, max_size=5),
    rules=st.lists(RULES, max_size=4, unique=True),
    conclusion=LITERALS | RULES,
)
def test_arguments_are_the_least_consistent_parts_of_the_beliefs_that_derive_the_conclusion(
    literals: frozenset[Literal], rules: list[Rule], conclusion: Belief
) -> None:
    granted = frozenset(conclusion.premises) if isinstance(conclusion, Rule) else frozenset[Literal]()
    goal = conclusion.conclusion if isinstance(conclusion, Rule) else conclusion
    beliefs: list[Literal | Rule] = [*literals, *rules]
    parts = [frozenset(some) for size in range(len(beliefs) + 1) for some in combinations(beliefs, size)]
    deriving = [part for part in parts if derives(part, goal, granted)]
    least = {part for part in deriving if not any(other < part for other in deriving)}

    def is_consistent(part: frozenset[Literal | Rule]) -> bool:
        conclusions = {each.conclusion if isinstance(each, Rule) else each for each in part}
        return consistent(frozenset(conclusions | granted | {goal}))

    found = {argument.support for argument in arguments_for(conclusion, literals, rules)}
    assert found == {part for part in least if is_consistent(part)}
