"""The lobby: who plays together. Any mix of arrivals, departures and times keeps all promises."""

from collections import Counter
from dataclasses import dataclass, field

from hypothesis import given, settings
from hypothesis import strategies as st

from thbridge.experiment.design.lobby import WaitRule
from thbridge.experiment.lobby import FormedGroup, Lobby, PoolRule, SeatHolder, WaitEnded, WaitingPerson

SEATS = ("driver", "namer", "guide", "scout")
RULES = st.builds(
    lambda number, wait, then, least, kind, random: PoolRule(
        SEATS[:number],
        wait,
        then,
        min(least, number),
        quota={"yes": 1, "no": number - 1} if kind == "quota" else {},
        seat_of={seat: "yes" if seat == "driver" else "no" for seat in SEATS[:number]} if kind == "seats" else {},
        random_seed=random,
    ),
    st.integers(2, 4),
    st.sampled_from([5.0, 60.0]),
    st.sampled_from(WaitRule),
    st.integers(1, 4),
    st.sampled_from(["arrival", "quota", "seats"]),
    st.sampled_from([None, 3]),
)
ACTS = st.lists(
    st.tuples(
        st.sampled_from(["enter", "enter", "enter", "leave"]),
        st.floats(0.0, 20.0),
        st.sampled_from(["yes", "no", "maybe"]),
        st.integers(0, 30),
    ),
    max_size=40,
)


ROUNDING = 1e-9
"""Largest error of a difference of two times, s."""


@dataclass
class Visit:
    """All that happened in a lobby."""

    rule: PoolRule
    lobby: Lobby = field(default_factory=Lobby)
    entered: dict[str, WaitingPerson] = field(default_factory=dict)
    left: set[str] = field(default_factory=set)
    groups: list[FormedGroup] = field(default_factory=list)
    ended: list[WaitEnded] = field(default_factory=list)
    order: list[list[str]] = field(default_factory=list)

    def match(self, now: float) -> None:
        self.lobby, found = self.lobby.matched(now)
        self.order += [[each.participant] if isinstance(each, WaitEnded) else [*each.people.values()] for each in found]
        self.groups += [each for each in found if isinstance(each, FormedGroup)]
        self.ended += [each for each in found if isinstance(each, WaitEnded)]


def visit(rule: PoolRule, acts: list[tuple[str, float, str, int]]) -> Visit:
    """Let people come and leave, then wait until no one waits any more."""
    seen, now = Visit(rule), 0.0
    for number, (act, pause, value, who) in enumerate(acts):
        now += pause
        seen.match(now)
        if act == "enter":
            person = WaitingPerson(f"P-{number}", "game", now, value)
            seen.entered[person.participant] = person
            seen.lobby = seen.lobby.enter(person, rule)
        elif seen.lobby.waiting:
            person = seen.lobby.waiting[who % len(seen.lobby.waiting)]
            seen.left.add(person.participant)
            seen.order.append([person.participant])
            seen.lobby = seen.lobby.leave(person.participant)
        seen.match(now)
    while (end := seen.lobby.next_end) is not None:
        seen.match(end)
    return seen


@settings(deadline=None)
@given(RULES, ACTS)
def test_everyone_who_waits_gets_one_game_or_one_ending(
    rule: PoolRule, acts: list[tuple[str, float, str, int]]
) -> None:
    seen = visit(rule, acts)
    played = Counter(person for group in seen.groups for person in group.people.values())
    ended = Counter(each.participant for each in seen.ended)
    assert set(played + ended) == {*seen.entered} - seen.left
    assert all(number == 1 for number in (played + ended).values())


@settings(deadline=None)
@given(RULES, ACTS)
def test_no_game_starts_with_fewer_people_unless_the_rule_allows_it(
    rule: PoolRule, acts: list[tuple[str, float, str, int]]
) -> None:
    for group in visit(rule, acts).groups:
        assert tuple(group.seats) == rule.seats
        assert {seat for seat, holder in group.seats.items() if holder is SeatHolder.PERSON} == {*group.people}
        missing = set(group.seats.values()) - {SeatHolder.PERSON}
        match rule.then:
            case WaitRule.PAY:
                assert not missing
            case WaitRule.FEWER:
                assert missing <= {SeatHolder.EMPTY}
                assert len(group.people) >= min(rule.least, len(rule.seats))
            case WaitRule.PROGRAM:
                assert missing <= {SeatHolder.PROGRAM}
        if missing:
            assert max(group.waited.values()) >= rule.wait - ROUNDING


@settings(deadline=None)
@given(RULES, ACTS)
def test_groups_and_seats_follow_values(rule: PoolRule, acts: list[tuple[str, float, str, int]]) -> None:
    seen = visit(rule, acts)
    for group in seen.groups:
        values = {seat: seen.entered[person].value for seat, person in group.people.items()}
        assert all(rule.seat_of.get(seat, value) == value for seat, value in values.items())
        if rule.quota:
            assert not Counter(values.values()) - Counter(rule.quota)


@settings(deadline=None)
@given(RULES, ACTS)
def test_nobody_waits_longer_than_the_rule_says(rule: PoolRule, acts: list[tuple[str, float, str, int]]) -> None:
    seen, late = visit(rule, acts), 20.0  # Time passes in steps of at most 20 s.
    waits = [wait for group in seen.groups for wait in group.waited.values()] + [each.waited for each in seen.ended]
    assert max(waits, default=0.0) <= rule.wait + late


@settings(deadline=None)
@given(RULES, ACTS)
def test_nobody_is_passed_by_a_person_with_the_same_value(
    rule: PoolRule, acts: list[tuple[str, float, str, int]]
) -> None:
    seen = visit(rule, acts)
    turn = {person: number for number, people in enumerate(seen.order) for person in people}
    kinds: dict[str, list[str]] = {}
    for person in seen.entered.values():
        kinds.setdefault(rule.kind_of(person), []).append(person.participant)
    for people in kinds.values():
        for index, person in enumerate(people):
            if person not in seen.left:
                assert all(turn[earlier] <= turn[person] for earlier in people[:index])


@settings(deadline=None)
@given(RULES, ACTS)
def test_equal_visits_give_equal_groups(rule: PoolRule, acts: list[tuple[str, float, str, int]]) -> None:
    once, again = visit(rule, acts), visit(rule, acts)
    assert (once.groups, once.ended) == (again.groups, again.ended)


def test_a_person_who_left_does_not_block_the_others() -> None:
    lobby, rule = Lobby(), PoolRule(SEATS[:2])
    for name in ("a", "b", "c"):
        lobby = lobby.enter(WaitingPerson(name, "game", 0.0), rule)
        if name == "a":
            lobby = lobby.leave("a")
    lobby, (group,) = lobby.matched(0.0)
    assert group.people == {"driver": "b", "namer": "c"}
    assert lobby.waiting == ()


def test_people_of_a_known_group_keep_their_seats_and_wait_for_each_other() -> None:
    rule = PoolRule(SEATS[:3], fixed={"a": "guide", "b": "driver"}, others={"namer": SeatHolder.PROGRAM})
    lobby = Lobby().enter(WaitingPerson("a", "group", 0.0), rule)
    lobby, found = lobby.matched(1.0)
    assert not found
    lobby, (group,) = lobby.enter(WaitingPerson("b", "group", 2.0), rule).matched(2.0)
    assert group.people == {"driver": "b", "guide": "a"}
    assert group.seats["namer"] is SeatHolder.PROGRAM


def test_random_seats_depend_on_the_seed_alone() -> None:
    def seats(seed: int) -> list[str]:
        found, lobby, rule = [], Lobby(), PoolRule(SEATS, random_seed=seed)
        for number in range(40):
            lobby, groups = lobby.enter(WaitingPerson(str(number), "game", 0.0), rule).matched(0.0)
            found += [next(iter(group.people.values())) for group in groups]
        return [str(int(person) % 4) for person in found]

    assert seats(1) == seats(1) != seats(2)
    assert len(set(seats(1))) > 1
