"""Explanations on request: reasons for or against a choice, a robot's knowledge, and facts that would change its mind.

An explanation consists of literals that the robot believes, or of literals that would each lead it to another decision.
So its contents are true by construction.
"""

from thbridge.dialogue.argumentation.arguments import Argument
from thbridge.dialogue.argumentation.propositions import Literal, Proposition
from thbridge.dialogue.moves import Enquire, Explain, Question
from thbridge.dialogue.propositions import (
    CostOfOther,
    CostsMore,
    DearerPlan,
    EnergyCost,
    InTheWay,
    LeftBehind,
    LessThan,
    NextRoom,
    ShorterPlan,
    TakesPicture,
    TeamPlan,
)
from thbridge.dialogue.robot_arguments import Evidence, WhatFacts, WhereFacts, comparison, is_below
from thbridge.dialogue.wording.wording import reasons
from thbridge.hunt.rooms import Room


def questions(facts: WhereFacts | WhatFacts, evidence: Evidence, claim: Literal) -> tuple[Enquire, ...]:
    """Return the possible questions about a decision that have an answer.

    Args:
        facts: the robot's facts.
        evidence: evidence from these facts.
        claim: the literal that the dialogue is about.
    """
    decision = evidence.decision
    possible = [Enquire(Question.WHY_NOT, _rival(facts, evidence, claim))]
    if decision is not None:
        possible.insert(0, Enquire(Question.WHY_THIS, decision))
        if isinstance(facts, WhereFacts):
            others = (Question.WHY_ROBOT, Question.WHY_NOW, Question.CHANGE)
            possible += [Enquire(question, decision) for question in others]
    possible.append(Enquire(Question.KNOWN, claim))
    return tuple(each for each in possible if each.about is not None and explain(each, facts, evidence).because)


def explain(asked: Enquire, facts: WhereFacts | WhatFacts, evidence: Evidence) -> Explain:
    """Return the answer to a question. If the robot has no reasons, the answer contains none."""
    about, because = asked.about, tuple[Literal, ...]()
    match asked.question:
        case Question.WHY_THIS if about is not None:
            because = _premises(_best_argument(evidence, about))
        case Question.WHY_NOT if about is not None:
            because = _contrast(evidence, about) or _premises(_best_argument(evidence, ~about))
        case Question.WHY_ROBOT if about is not None and isinstance(facts, WhereFacts):
            because = _against_other_robots(facts, about)
        case Question.WHY_NOW if about is not None and isinstance(facts, WhereFacts):
            because = _before_the_next(facts, about)
        case Question.KNOWN if about is not None:
            because = _known(evidence, about)
        case Question.CHANGE if about is not None and isinstance(facts, WhereFacts):
            because = _would_change(facts, about)
    return Explain(asked.question, about, because)


def _rival(facts: WhereFacts | WhatFacts, evidence: Evidence, claim: Literal) -> Literal | None:
    """Return an alternative that the robot rejects, and that a person may ask about."""
    decision = evidence.decision
    if decision != claim:
        return claim
    if isinstance(facts, WhatFacts):
        other = Literal(TakesPicture(facts.room))
        return None if other == decision else other
    goes = decision.proposition if decision is not None else None
    others = [room for room in facts.values if not (isinstance(goes, NextRoom) and goes.room == room)]
    nearest = min(others, key=lambda room: (facts.costs.get(room, 0.0), room), default=None)
    return None if nearest is None else Literal(NextRoom(facts.robot, nearest))


def _best_argument(evidence: Evidence, conclusion: Literal) -> Argument | None:
    """Return the argument that is based on the best evidence.

    Among arguments based on equal evidence, choose an argument with comparisons, because comparisons explain more.
    """
    found = evidence.beliefs.arguments(conclusion)
    prefers = evidence.beliefs.prefers

    def rank(argument: Argument) -> tuple[int, int, str]:
        compares = any(isinstance(premise.proposition, TeamPlan) for premise in argument.premises)
        return sum(prefers(other, argument) for other in found), -compares, str(argument)  # of integers

    return min(found, key=rank, default=None)


def _contrast(evidence: Evidence, about: Literal) -> tuple[Literal, ...]:
    """Return the team's costs of going to a room instead of the best room, if the robot has compared both."""
    room = getattr(about.proposition, "room", None)
    kinds = (ShorterPlan, DearerPlan, LeftBehind)
    found = [literal for literal in evidence.beliefs.origins if isinstance(literal.proposition, kinds)]
    return tuple(literal for literal in found if getattr(literal.proposition, "room", None) == room)


def _premises(argument: Argument | None) -> tuple[Literal, ...]:
    """Return the premises of an argument, in the order of the sentence."""
    if argument is None:
        return ()
    return tuple(reason for reason in reasons(argument.premises, argument.conclusion) if isinstance(reason, Literal))


def _known(evidence: Evidence, about: Literal) -> tuple[Literal, ...]:
    """Return all evidence about the same room, without comparisons."""
    room = getattr(about.proposition, "room", None)

    def speaks_of_it(proposition: Proposition) -> bool:
        named = [getattr(proposition, name, None) for name in ("room", "goal")]
        return room is not None and room in named

    return tuple(
        literal
        for literal, origin in evidence.beliefs.origins.items()
        if origin.is_evidence and literal != about and speaks_of_it(literal.proposition)
    )


def _against_other_robots(facts: WhereFacts, about: Literal) -> tuple[Literal, ...]:
    """Return the value of a room for this robot, and for the other robot with the closest value."""
    room: Room | None = getattr(about.proposition, "room", None)
    if room is None or room not in facts.values or not facts.compares:
        return ()
    own = facts.values[room]
    others = {robot: values[room] for robot, values in facts.team_values.items() if room in values}
    if others:
        robot = min(others, key=lambda each: (-others[each].rooms, others[each].cost, each))
        difference = comparison(own, others[robot])
        if difference is not None:
            return (
                Literal(TeamPlan(facts.robot, room, own.rooms, own.cost)),
                Literal(TeamPlan(robot, room, others[robot].rooms, others[robot].cost)),
                Literal(difference),
            )
    costs = {robot: row[room] for robot, row in facts.team_costs.items() if room in row}
    mine = facts.costs.get(room)
    if mine is None or not costs:
        return ()
    robot = min(costs, key=lambda each: (costs[each], each))
    if not is_below(mine, costs[robot]):
        return ()
    return (
        Literal(EnergyCost(facts.here, room, mine)),
        Literal(CostOfOther(robot, room, costs[robot])),
        Literal(LessThan((mine,), costs[robot])),
    )


def _before_the_next(facts: WhereFacts, about: Literal) -> tuple[Literal, ...]:
    """Return the values of going to a room now, and of beginning with the next room of the tour instead."""
    room: Room | None = getattr(about.proposition, "room", None)
    if room is None or facts.tour[:1] != (room,) or len(facts.tour) < 2 or not facts.compares:
        return ()
    now, then = (facts.values.get(each) for each in facts.tour[:2])
    difference = None if now is None or then is None or not facts.proven else comparison(now, then)
    if now is None or then is None or difference is None:
        return ()
    return (
        Literal(TeamPlan(facts.robot, room, now.rooms, now.cost)),
        Literal(TeamPlan(facts.robot, facts.tour[1], then.rooms, then.cost)),
        Literal(difference),
    )


def _would_change(facts: WhereFacts, about: Literal) -> tuple[Literal, ...]:
    """Return literals that would each lead to another room: an obstacle in the way, or a higher cost of the path."""
    room: Room | None = getattr(about.proposition, "room", None)
    if room is None or room not in facts.values:
        return ()
    hypotheses = [Literal(InTheWay(room))]
    own, cost = facts.values[room], facts.costs.get(room)
    rivals = [value for other, value in facts.values.items() if other != room and value.rooms == own.rooms]
    if cost is not None and rivals and facts.compares and facts.proven:
        margin = min(value.cost for value in rivals) - own.cost
        hypotheses.append(Literal(CostsMore(facts.here, room, cost + margin)))
    return tuple(hypotheses)
