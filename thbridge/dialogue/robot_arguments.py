"""Evidence of a robot for the three decisions of the hunt: its knowledge, and the arguments that follow from it.

Evidence never contains knowledge that only the simulator has. It contains the robot's energy and costs, the energy and
costs that other robots report, the joint plan based on these, the robot's failures, and the known properties of
treasures.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from thbridge.dialogue.argumentation.beliefs import Beliefs, Origin, Source
from thbridge.dialogue.argumentation.propositions import Conjunction, Literal, Proposition, Rule, opposed
from thbridge.dialogue.propositions import (
    CostOfOther,
    CouldBe,
    DearerPlan,
    EnergyCost,
    EnergyLevel,
    FewerRooms,
    InTheWay,
    LeftBehind,
    LessThan,
    NamesTreasure,
    NamesTreasureAs,
    NamingCost,
    NextRoom,
    NoWay,
    PictureCost,
    PictureTaken,
    PropertyFound,
    PropertyListed,
    RoomSequence,
    SeenInPicture,
    Settled,
    ShorterPlan,
    TakesPicture,
    TeamPlan,
    TreasureIn,
    UnderWay,
    VisitOrder,
    Wanted,
)
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_tour import PlanValue


@dataclass(frozen=True, slots=True)
class WhereFacts:
    """Facts of a robot about its possible next rooms.

    Attributes:
        robot: index in the team, from 0.
        here: the place where it stands.
        energy: energy that it has left.
        costs: energy for a move to each unvisited room; rooms without a path are missing.
        left: rooms that have not been visited.
        under_way: rooms to which other robots drive, or to which they have agreed to go.
        values: by room, the value for the team if this room is this robot's next room.
        others: by room, move costs of those other robots that the plan sends to this room first.
        failed: rooms to which the robot was sent and that it did not reach, or to which it has no path.
        team_costs: costs of the other robots to rooms, by their indices.
        team_values: by the index of another robot and by room, the value for the team if this room is that robot's next
            room.
        tour: rooms that the plan assigns to it, in their order.
        advised: the room that its planner chose. If None, it is the room with the highest value.
        compares: False if the robot's only reason for a room is the cost, as for an adviser that may give wrong advice.
        proven: False if the plans may not be optimal; then their values are not compared.
        left_behind: by room, the robots that get no room in the plan if this robot goes there.
        confidence: the robot's confidence in its localization, 0 to 1.
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
    team_costs: Mapping[int, Mapping[Room, float]] = field(default_factory=dict)
    team_values: Mapping[int, Mapping[Room, PlanValue]] = field(default_factory=dict)
    tour: tuple[Room, ...] = ()
    advised: Room | None = None
    compares: bool = True
    proven: bool = True
    left_behind: Mapping[Room, Mapping[int, Room]] = field(default_factory=dict)
    confidence: float = 1.0
    at: float = 0.0


@dataclass(frozen=True, slots=True)
class Misfit:
    """Property of a treasure that contradicts a name of the treasure. The values are parts of sentences.

    Attributes:
        found: the value found.
        listed: the values of treasures with that name.
        is_told: True if the participant reported it.
    """

    found: str
    listed: str
    is_told: bool


@dataclass(frozen=True, slots=True)
class WhatFacts:
    """Facts of a robot about a found treasure.

    Attributes:
        room: room of the treasure.
        energy: energy that the robot has left.
        picture_cost: energy of a picture.
        naming_cost: energy of naming the treasure.
        names: names that fit everything known about the treasure, in alphabetical order.
        has_picture: True if there is a picture of it.
        at: simulated time, s.
        claimed: name that the participant wants to give to the treasure; empty if the participant proposes no name.
        against: properties that this name does not fit, as parts of sentences.
        unsure: True if the participant asks the robot what the treasure is.
    """

    room: Room
    energy: float
    picture_cost: float
    naming_cost: float
    names: tuple[str, ...]
    has_picture: bool
    at: float = 0.0
    claimed: str = ""
    against: tuple[Misfit, ...] = ()
    unsure: bool = False


def situation_of(facts: WhereFacts | WhatFacts) -> WhereFacts | WhatFacts:
    """Return the facts without facts that depend on the time or the question. Equal results mean the same situation."""
    if isinstance(facts, WhereFacts):
        return replace(facts, at=0.0, advised=None, left_behind={})
    return replace(facts, at=0.0, claimed="", against=(), unsure=False)


@dataclass(frozen=True, slots=True)
class Evidence:
    """Beliefs of a robot for one decision.

    Attributes:
        beliefs: sensed and computed beliefs, with the rules of the language, and the decision.
        decision: the robot's decision; None if there is no decision.
        order: order of its tour up to the compared room; None if that room is not a later stop of the tour.
        doubt: a literal about which a dialogue may ask because the robot has no decision; None if there is none.
    """

    beliefs: Beliefs
    decision: Literal | None
    order: Literal | None = None
    doubt: Literal | None = None


def where(facts: WhereFacts, told: Beliefs | None = None, rival: Room | None = None) -> Evidence:
    """Return a robot's beliefs about where to go.

    Args:
        facts: the robot's facts.
        `told`: accepted statements of the person, as beliefs; they also affect the robot's decision.
        rival: room to compare with the best room. If None, this is the room with the lowest cost.
    """
    case = _Case(facts.at, told)
    level = case.knows(EnergyLevel(facts.energy))
    enough = {room: _affordable(case, facts, room, level) for room in facts.left}
    best = _best(facts, case)
    if best is None:
        return case.evidence(None, ())
    others = [room for room in facts.left if room != best]
    # A person may have persuaded the robot of a room that has no value in the plan.
    comparable = facts.values if facts.compares and best in facts.values else {}
    compared = {room: _compared(case, facts, best, room) for room in others if room in comparable}
    nearest = min(compared, key=lambda room: (facts.costs.get(room, math.inf), room), default=None)
    if rival is not None and compared.get(rival):
        _contrasted(case, facts, best, rival)
    reasons = compared.get(rival if rival in compared and rival is not None else nearest or best) or enough[best]
    if best in comparable and not facts.proven:
        reasons = (_planned(case, facts, best),)
    goes = Literal(NextRoom(facts.robot, best))
    case.rule(reasons, goes)
    # A choice of one room is a decision against all other rooms (Sklar and Azhar 2015).
    rest = tuple(Literal(NextRoom(facts.robot, room), holds=False) for room in others)
    order = None if rival is None else _order(facts.tour, best, rival)
    if order is None or not compared.get(rival or best):
        return case.evidence(goes, rest)
    case.rule(reasons, order)
    return replace(case.evidence(goes, (*rest, order)), order=order)


def is_decision(literal: Literal) -> bool:
    """Return True for decisions and wishes, which are only valid in one situation."""
    decided = (
        NextRoom | VisitOrder | RoomSequence | Conjunction | TakesPicture | NamesTreasure | NamesTreasureAs | Wanted
    )
    return isinstance(literal.proposition, decided)


def is_hearsay(literal: Literal) -> bool:
    """Return True for beliefs that a robot holds only because a person persuaded the robot."""
    return is_decision(literal) or isinstance(literal.proposition, InTheWay | SeenInPicture)


def what(facts: WhatFacts, told: Beliefs | None = None) -> Evidence:
    """Return a robot's beliefs about naming a treasure, or first taking a picture of it."""
    case = _Case(facts.at, told)
    level = case.knows(EnergyLevel(facts.energy))
    picture, naming = case.knows(PictureCost(facts.picture_cost)), case.knows(NamingCost(facts.naming_cost))
    takes, names = Literal(TakesPicture(facts.room)), named(facts)
    both = (facts.picture_cost, facts.naming_cost)
    decision = None
    for misfit in facts.against:
        source = Source.TOLD if misfit.is_told else Source.SENSED
        found = case.knows(PropertyFound(facts.room, misfit.found), source=source)
        case.rule((found, case.knows(PropertyListed(facts.claimed, misfit.listed))), ~names)
    if facts.claimed:
        # Only a person who sees the picture can answer.
        case.rule((Literal(SeenInPicture(facts.room, facts.claimed)),), names)
    # If the person proposes no name, or a name that does not fit, the robot looks for a name.
    own_name = facts.unsure or bool(facts.against)
    if facts.has_picture:
        taken = case.knows(PictureTaken(facts.room))
        case.rule((taken,), ~takes)
        if not own_name:
            case.rule((taken,), names)
            decision = names
    if len(facts.names) == 1 and (own_name or not facts.has_picture):
        settled = case.knows(Settled(facts.room, facts.names[0]))
        case.rule((settled, picture), ~takes)
        decision = Literal(NamesTreasureAs(facts.room, facts.names[0])) if own_name else names
        case.rule((settled, naming, level), decision)
    elif not facts.has_picture:
        several = case.knows(CouldBe(facts.room, facts.names))
        case.rule((several, picture), ~names)
        if math.fsum(both) <= facts.energy:
            enough = (picture, naming, level)
            case.rule((several, *enough), takes)
            decision = takes
    for told_so in (takes, names):
        if case.was_told(told_so):
            decision = told_so
        elif case.was_told(~told_so) and decision == told_so:
            decision = None
    if math.fsum(both) > facts.energy:
        short = case.knows(LessThan((facts.energy,), math.fsum(both)))
        case.rule((picture, naming, level, short), ~takes)
    rest = tuple(~other for other in (takes, names) if decision and other != decision)
    doubt = Literal(TreasureIn(facts.names[0], facts.room)) if own_name and decision is None and facts.names else None
    return replace(case.evidence(decision, rest), doubt=doubt)


def named(facts: WhatFacts) -> Literal:
    """Return the literal "the treasure is named now". If a name is claimed, the literal contains this name."""
    return Literal(NamesTreasureAs(facts.room, facts.claimed) if facts.claimed else NamesTreasure(facts.room))


def is_below(energy: float, other: float) -> bool:
    """Return True if an energy is below another energy after rounding to two decimals, as people read energies."""
    return round(energy, 2) < round(other, 2)


def comparison(better: PlanValue, worse: PlanValue) -> Proposition | None:
    """Return the reason why a plan is better than another plan, or None if it is not better."""
    if better.rooms > worse.rooms:
        return FewerRooms(worse.rooms, better.rooms)
    if better.rooms == worse.rooms and is_below(better.cost, worse.cost):
        return LessThan((better.cost,), worse.cost)
    return None


def reasons_of_a_person(claim: Literal, facts: WhereFacts | WhatFacts) -> Beliefs:
    """Return a person's possible reasons for a claim: a wish, and facts that both people and robots see."""
    wish = Literal(Wanted(claim))
    reasons: dict[Literal, Rule] = {wish: Rule((wish,), claim, is_said=False)}
    if isinstance(facts, WhereFacts) and isinstance(claim.proposition, NextRoom):
        room = claim.proposition.room
        if not claim.holds:
            blocked = Literal(InTheWay(room))
            reasons[blocked] = Rule((blocked,), claim, is_said=False)
        elif len(facts.costs) > 1 and (cost := facts.costs.get(room)) == min(facts.costs.values()) and cost is not None:
            nearest = Literal(EnergyCost(facts.here, room, cost))
            reasons[nearest] = Rule((nearest,), claim, is_said=False)
    if isinstance(facts, WhatFacts) and claim == named(facts) and facts.claimed and facts.has_picture:
        seen = Literal(SeenInPicture(facts.room, facts.claimed))
        reasons[seen] = Rule((seen,), claim, is_said=False)
    return Beliefs.of(reasons, reasons.values(), Source.TOLD)


class _Case:
    """Collector of beliefs; each literal added with `knows` is sensed or computed at this time."""

    def __init__(self, at: float, told: Beliefs | None) -> None:
        self._at = at
        self._told = told or Beliefs()
        self._gathered: dict[Literal, Origin] = {}
        self._rules: dict[Rule, None] = {}

    def knows(self, proposition: Proposition, *, confidence: float = 1.0, source: Source | None = None) -> Literal:
        literal, usual = Literal(proposition), _SOURCES.get(type(proposition), Source.COMPUTED)
        # This key gives the order of reasons; comparisons come last.
        self._gathered.pop(literal, None)
        self._gathered[literal] = Origin(source or usual, self._at, confidence)
        return literal

    def rule(self, premises: tuple[Literal, ...], conclusion: Literal) -> None:
        self._rules[Rule(premises, conclusion, is_said=False)] = None

    def was_told(self, conclusion: Literal) -> bool:
        """Return True for a conclusion that the robot holds because a person persuaded the robot."""
        return conclusion in self._told

    def is_against(self, conclusion: Literal) -> bool:
        """Return True if evidence, or an accepted statement, is against a conclusion."""
        known = self._told.origins.keys() | self._gathered.keys()
        by_rule = (rule for rule in self._rules if rule.conclusion == ~conclusion)
        return self.was_told(~conclusion) or any(known.issuperset(rule.premises) for rule in by_rule)

    def evidence(self, decision: Literal | None, rest: tuple[Literal, ...]) -> Evidence:
        """Return the beliefs with a decision.

        Accepted statements that contradict evidence or the decision are dropped.
        """
        gathered = tuple(self._gathered)
        told = {
            literal: origin
            for literal, origin in self._told.origins.items()
            if not any(opposed(literal, known) for known in gathered)
        }
        rules = dict.fromkeys((*self._told.rules, *self._rules))
        beliefs = Beliefs({**told, **self._gathered}, tuple(rules))
        for decided in (*(each for each in (decision,) if each is not None), *rest):
            if decided not in beliefs:
                beliefs = beliefs.gaining(decided, Origin(Source.DECIDED, self._at))
        return Evidence(beliefs, decision)


_SOURCES: Mapping[type[Proposition], Source] = {
    EnergyLevel: Source.SENSED,
    NoWay: Source.SENSED,
    PictureTaken: Source.SENSED,
    CostOfOther: Source.TOLD,
    UnderWay: Source.TOLD,
}
"""Source of each kind of evidence. Evidence of a kind that is not listed is computed."""


def _affordable(case: _Case, facts: WhereFacts, room: Room, level: Literal) -> tuple[Literal, ...]:
    """Add the beliefs about whether the robot can reach a room at all; return the reasons if it can."""
    goes, cost = Literal(NextRoom(facts.robot, room)), facts.costs.get(room)
    case.rule((Literal(InTheWay(room)),), ~goes)
    if room in facts.under_way:
        case.rule((case.knows(UnderWay(facts.under_way[room], room)),), ~goes)
    if cost is None or room in facts.failed:
        case.rule((case.knows(NoWay(room)),), ~goes)
    if cost is None:
        return ()
    way = case.knows(EnergyCost(facts.here, room, cost), confidence=facts.confidence)
    if cost > facts.energy:
        case.rule((level, way, case.knows(LessThan((facts.energy,), cost))), ~goes)
        return ()
    # The robot may spend all of its energy on a move, so only an energy below the cost is too little.
    return (level, way, case.knows(LessThan((cost,), facts.energy))) if is_below(cost, facts.energy) else (level, way)


def _best(facts: WhereFacts, case: _Case) -> Room | None:
    """Return the room that the planner chose; otherwise the room of highest value with no evidence against it."""
    wanted = [room for room in facts.left if case.was_told(Literal(NextRoom(facts.robot, room)))]
    if wanted:
        return wanted[0]
    open_ones = [
        room
        for room in facts.left
        if room in facts.values and not case.is_against(Literal(NextRoom(facts.robot, room)))
    ]
    if facts.advised in open_ones:
        return facts.advised
    return min(open_ones, key=lambda room: (-facts.values[room].rooms, facts.values[room].cost, room), default=None)


def _contrasted(case: _Case, facts: WhereFacts, best: Room, rival: Room) -> None:
    """Add the belief about the team's costs of going to a room instead of the best room."""
    better, worse = facts.values[best], facts.values[rival]
    if better.rooms > worse.rooms:
        case.knows(ShorterPlan(rival, best, better.rooms - worse.rooms))
    else:
        case.knows(DearerPlan(rival, best, worse.cost - better.cost))
    for other, place in facts.left_behind.get(rival, {}).items():
        case.knows(LeftBehind(other, place, rival))


def _order(tour: tuple[Room, ...], first: Room, later: Room) -> Literal | None:
    """Return the order of a tour up to a later room; None if the tour does not begin with the first room."""
    if tour[:1] != (first,) or later not in tour[1:]:
        return None
    return Literal(RoomSequence(tour[: tour.index(later) + 1]))


def _compared(case: _Case, facts: WhereFacts, best: Room, room: Room) -> tuple[Literal, ...]:
    """Add the reasons against `room`, and return the reasons for `best` if it is the better room."""
    goes = Literal(NextRoom(facts.robot, room))
    difference = comparison(facts.values[best], facts.values[room])
    if difference is None:
        return ()
    if room in facts.others:
        other, cost = facts.others[room]
        own = facts.costs.get(room)
        if own is not None and is_below(cost, own):
            theirs = case.knows(CostOfOther(other, room, cost))
            way = case.knows(EnergyCost(facts.here, room, own), confidence=facts.confidence)
            case.rule((theirs, way, case.knows(LessThan((cost,), own))), ~goes)
    if not facts.proven:
        return ()
    reasons = (_planned(case, facts, best), _planned(case, facts, room), case.knows(difference))
    case.rule(reasons, ~goes)
    return reasons


def _planned(case: _Case, facts: WhereFacts, room: Room) -> Literal:
    """Add the belief about the result for the team if the robot goes to a room next."""
    value = facts.values[room]
    return case.knows(TeamPlan(facts.robot, room, value.rooms, value.cost), confidence=facts.confidence)
