"""Evidence of a robot for the three decisions of the hunt: what it knows, and which arguments that makes.

Nothing is in here that only the simulator knows: the robot's own energy and costs, what the others of its team say of
theirs, the joint plan made of these, its own failures, and what was found out about treasures.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from thbridge.argumentation.beliefs import Beliefs, Origin, Source
from thbridge.argumentation.propositions import Literal, Proposition, Rule
from thbridge.dialogue.propositions import (
    CostOfOther,
    CouldBe,
    EnergyCost,
    EnergyLevel,
    FewerRooms,
    InTheWay,
    LessThan,
    NamesTreasure,
    NamingCost,
    NextRoom,
    NoWay,
    PictureCost,
    PictureTaken,
    Settled,
    TakesPicture,
    TeamPlan,
    UnderWay,
    Wanted,
)
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_tour import PlanValue


@dataclass(frozen=True, slots=True)
class WhereFacts:
    """Facts of a robot about where to go next.

    Attributes:
        robot: index in the team, from 0.
        here: the place where it stands.
        energy: it has left.
        costs: energy to each room that is left; rooms without a way are left out.
        left: rooms that nobody has looked into.
        under_way: rooms that other robots drive to or have agreed to go to.
        values: what each room as its next one is worth to the team.
        others: costs of those robots of the team that the plan sends to a room first, by room.
        failed: rooms that it did not reach when it was sent there, or has no way to.
        confidence: of its localisation, 0 to 1.
        at: simulated time, s.
    """

    robot: int
    here: Room
    energy: float
    costs: Mapping[Room, float]
    left: tuple[Room, ...]
    under_way: Mapping[Room, int] = field(default_factory=dict)
    values: Mapping[Room, PlanValue] = field(default_factory=dict)
    others: Mapping[Room, tuple[int, float]] = field(default_factory=dict)
    failed: frozenset[Room] = frozenset()
    confidence: float = 1.0
    at: float = 0.0


@dataclass(frozen=True, slots=True)
class WhatFacts:
    """Facts of a robot about a treasure that was found.

    Attributes:
        room: where it is.
        energy: the robot has left.
        picture_cost: energy of a picture.
        naming_cost: energy of naming it.
        names: that fit all that is known of it, in alphabetical order.
        has_picture: True when there is a picture of it.
        at: simulated time, s.
    """

    room: Room
    energy: float
    picture_cost: float
    naming_cost: float
    names: tuple[str, ...]
    has_picture: bool
    at: float = 0.0


@dataclass(frozen=True, slots=True)
class Evidence:
    """Beliefs of a robot for one decision.

    Attributes:
        beliefs: sensed and computed, with the rules of the language, and its decision.
        decision: what it would do; None where it sees nothing to do.
        shown: evidence that the participant sees in the window: costs, energies, robots under way.
    """

    beliefs: Beliefs
    decision: Literal | None
    shown: frozenset[Literal]


def where(facts: WhereFacts, told: Beliefs | None = None) -> Evidence:
    """Return what a robot believes about where to go.

    Args:
        facts: what it knows.
        told: what it was told before and accepted; its decision goes by that too.
    """
    case = _Case(facts.at, told)
    level = case.knows(EnergyLevel(facts.energy))
    for room in facts.left:
        _affordable(case, facts, room, level)
    best = _best(facts, case)
    if best is not None:
        for room in facts.left:
            if room != best and room in facts.values:
                _compared(case, facts, best, room)
    decision = None if best is None else Literal(NextRoom(facts.robot, best))
    return case.evidence(decision)


def what(facts: WhatFacts, told: Beliefs | None = None) -> Evidence:
    """Return what a robot believes about naming a treasure, or taking a picture of it first."""
    case = _Case(facts.at, told)
    level = case.knows(EnergyLevel(facts.energy))
    picture, naming = case.knows(PictureCost(facts.picture_cost)), case.knows(NamingCost(facts.naming_cost))
    takes, names = Literal(TakesPicture(facts.room)), Literal(NamesTreasure(facts.room))
    decision = None
    both = (facts.picture_cost, facts.naming_cost)
    if facts.has_picture:
        taken = case.knows(PictureTaken(facts.room))
        case.rule((taken,), ~takes)
        case.rule((taken,), names)
        decision = names
    elif len(facts.names) == 1:
        settled = case.knows(Settled(facts.room, facts.names[0]))
        case.rule((settled, picture), ~takes)
        case.rule((settled, naming, level), names)
        decision = names
    else:
        several = case.knows(CouldBe(facts.room, facts.names))
        case.rule((several, picture), ~names)
        if sum(both) <= facts.energy:
            enough = (picture, naming, level)
            case.rule((several, *enough), takes)
            decision = takes
    if sum(both) > facts.energy:
        short = case.knows(LessThan((facts.energy,), sum(both)))
        case.rule((picture, naming, level, short), ~takes)
    return case.evidence(decision)


def reasons_of_a_person(claim: Literal, facts: WhereFacts | WhatFacts) -> Beliefs:
    """Return what a person could put forward for a claim: her wish, and what she sees as well as the robot does."""
    wish = Literal(Wanted(claim))
    reasons: dict[Literal, Rule] = {wish: Rule((wish,), claim, is_said=False)}
    if isinstance(facts, WhereFacts) and isinstance(claim.proposition, NextRoom):
        room = claim.proposition.room
        if not claim.holds:
            blocked = Literal(InTheWay(room))
            reasons[blocked] = Rule((blocked,), claim, is_said=False)
        elif (cost := facts.costs.get(room)) is not None:
            dearer = [other for other, price in facts.costs.items() if price > cost]
            if dearer and len(dearer) == len(facts.costs) - 1:
                own = Literal(EnergyCost(facts.here, room, cost))
                reasons[own] = Rule((own,), claim, is_said=False)
    return Beliefs.of(reasons, reasons.values(), Source.TOLD)


class _Case:
    """Beliefs as they are gathered; what is asked to be known is sensed or computed at this time."""

    def __init__(self, at: float, told: Beliefs | None, confidence: float = 1.0) -> None:
        self._at, self._confidence = at, confidence
        self._beliefs = told or Beliefs()
        self._rules: list[Rule] = []
        self._shown: set[Literal] = set()

    def knows(self, proposition: Proposition, *, confidence: float = 1.0) -> Literal:
        literal = Literal(proposition)
        shown = isinstance(proposition, _SHOWN)
        source = Source.SENSED if shown else Source.COMPUTED
        self._beliefs = self._beliefs.gaining(literal, Origin(source, self._at, confidence))
        if shown:
            self._shown.add(literal)
        return literal

    def rule(self, premises: tuple[Literal, ...], conclusion: Literal) -> None:
        self._rules.append(Rule(premises, conclusion, is_said=False))

    def is_against(self, conclusion: Literal) -> bool:
        """True when there is evidence, or something told, against a conclusion."""
        return bool(
            ~conclusion in self._beliefs or Beliefs(self._beliefs.origins, tuple(self._rules)).arguments(~conclusion)
        )

    def evidence(self, decision: Literal | None) -> Evidence:
        rules = (*(rule for rule in self._beliefs.rules if rule not in self._rules), *self._rules)
        beliefs = Beliefs(self._beliefs.origins, rules)
        if decision is not None:
            beliefs = beliefs.gaining(decision, Origin(Source.DECIDED, self._at))
        return Evidence(beliefs, decision, frozenset(self._shown))


_SHOWN = (EnergyLevel, EnergyCost, CostOfOther, UnderWay, PictureCost, NamingCost, PictureTaken)


def _affordable(case: _Case, facts: WhereFacts, room: Room, level: Literal) -> None:
    """Gather whether the robot can get to a room at all."""
    goes, cost = Literal(NextRoom(facts.robot, room)), facts.costs.get(room)
    in_the_way = Literal(InTheWay(room))
    case.rule((in_the_way,), ~goes)
    if room in facts.under_way:
        case.rule((case.knows(UnderWay(facts.under_way[room], room)),), ~goes)
    if cost is None or room in facts.failed:
        case.rule((case.knows(NoWay(room)),), ~goes)
    if cost is None:
        return
    way = case.knows(EnergyCost(facts.here, room, cost), confidence=facts.confidence)
    if cost <= facts.energy:
        if cost < facts.energy:
            enough = case.knows(LessThan((cost,), facts.energy))
            case.rule((level, way, enough), goes)
    else:
        case.rule((level, way, case.knows(LessThan((facts.energy,), cost))), ~goes)


def _best(facts: WhereFacts, case: _Case) -> Room | None:
    """The room that the plan values most, of those against which nothing stands."""
    open_ones = [
        room
        for room in facts.left
        if room in facts.values and not case.is_against(Literal(NextRoom(facts.robot, room)))
    ]
    return min(open_ones, key=lambda room: (-facts.values[room].rooms, facts.values[room].cost, room), default=None)


def _compared(case: _Case, facts: WhereFacts, best: Room, room: Room) -> None:
    """Gather the reasons for the best room, and against another one."""
    better, worse = facts.values[best], facts.values[room]
    mine, goes = Literal(NextRoom(facts.robot, best)), Literal(NextRoom(facts.robot, room))
    if better.rooms > worse.rooms:
        difference: Proposition = FewerRooms(worse.rooms, better.rooms)
    elif better.cost < worse.cost:
        difference = LessThan((better.cost,), worse.cost)
    else:
        return
    premises = (
        case.knows(TeamPlan(facts.robot, best, better.rooms, better.cost), confidence=facts.confidence),
        case.knows(TeamPlan(facts.robot, room, worse.rooms, worse.cost), confidence=facts.confidence),
        case.knows(difference),
    )
    case.rule(premises, ~goes)
    if room in facts.others:
        other, cost = facts.others[room]
        own = facts.costs.get(room)
        if own is not None and cost < own:
            theirs = case.knows(CostOfOther(other, room, cost))
            way = case.knows(EnergyCost(facts.here, room, own), confidence=facts.confidence)
            case.rule((theirs, way, case.knows(LessThan((cost,), own))), ~goes)
    case.rule(premises, mine)
