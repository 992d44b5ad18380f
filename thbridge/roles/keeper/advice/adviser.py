"""Advice of a robot about its next room: the robot's first room in the team's plan, and the reason for this room.

A study can set the share of wrong advice.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

from sim.numerics import noise
from thbridge.dialogue.wording.texts import Texts
from thbridge.files.language_texts import shipped_texts
from thbridge.hunt import rules
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import Commander, RoomAdvised
from thbridge.hunt.game import GameState
from thbridge.hunt.planners import PLANNERS, PLANNING_ALONE, searched_tours
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.hunt.team_tour import MOST_ROOMS_OF_A_TEAM, TourStart
from thbridge.hunt.tour import Tour, why_no_tour
from thbridge.roles.shared.participant_rules import Discussed, Situation, free_to_discuss

_MOST_ROOMS_COMPARED = {1: 17, 2: MOST_ROOMS_OF_A_TEAM, 3: 14, 4: 13}
"""If at most this number of rooms remains, all plans are compared. The key is the number of robots; above 4, it is 12.

The game waits for the advice. Up to this number, the comparison takes at most 0.5 s. This time includes the values of
all other next rooms, because arguments need these values. For more rooms, a heuristic search takes the same time.
"""
_EXACT = frozenset({TeamPlanner.JOINT, TeamPlanner.TOUR})
"""Planners with optimal tours, for the team or for a single robot."""


@dataclass(frozen=True, slots=True)
class Advice:
    """A robot's suggestion of a room, with a reason and a confidence.

    Attributes:
        room: the suggested room.
        reason: reason as part of a sentence, such as "no other room costs me less".
        number: number of the robot's advice in this game, from 1.
        planned: the room that the planner chose.
        erred: True if the robot suggests a room other than the planned room.
        confidence: confidence that the robot states, 0 to 1, or None if it states no confidence.
    """

    room: Room
    reason: str
    number: int
    planned: Room
    erred: bool = False
    confidence: float | None = None

    def event(self, robot: int) -> RoomAdvised:
        """Return the event that records this advice of a robot."""
        return RoomAdvised(robot, self.room, self.number, self.planned, self.erred, self.confidence)

    def instead(self, room: Room, reason: str) -> "Advice":
        """Return the advice of a wizard who speaks for the robot: this room with this reason."""
        return self if room == self.room else replace(self, room=room, reason=reason, erred=False)


@dataclass(frozen=True, slots=True)
class Adviser:
    """Adviser that computes the robots' suggestions, with the settings of the study.

    Wrong advice is chosen randomly. The random numbers depend on the game, the robot and the number of the advice. If
    wrong advice is possible, reasons mention only the cost of the room. A comparison with other rooms would be false or
    would reveal the error.

    Attributes:
        planner: planner that chooses the room.
        error_rate: share of wrong advice. Wrong advice names another room, chosen randomly among all rooms that the
            robot could suggest.
        says_confidence: True if robots state their confidence.
        confidence_bias: number added to the confidence of a calibrated adviser. A calibrated adviser knows only the
            probability of wrong advice.
        confidence_spread: largest difference between this probability and its mean, the error rate. For each advice, a
            new probability is drawn from a uniform distribution.
        texts: texts of the game's language, for reasons.
    """

    planner: TeamPlanner = TeamPlanner.JOINT
    error_rate: float = 0.0
    says_confidence: bool = False
    confidence_bias: float = 0.0
    confidence_spread: float = 0.0
    texts: Texts = field(default_factory=shipped_texts)

    def advise(
        self, state: GameState, discussed: Sequence[Discussed], robot: int, number: int = 1
    ) -> Advice | RequestRefused:
        """Return the advice of a robot, or a refusal (`NoTour`) if it cannot suggest any room.

        A joint planner plans for all robots that the participant can send. Robots that are moving or will be sent soon
        continue from their goals, with the remaining energy after naming the treasure there. Rooms in dialogues with
        other robots are reserved for these robots. If there are too many rooms for a comparison of all plans, the joint
        plan is found by heuristic search.

        Args:
            state: state of the game.
            discussed: see `Situation`.
            robot: the robot that advises.
            number: number of the robot's advice in this game, from 1.
        """
        adviser, costs = state.robots[robot], state.started.costs
        free = tuple(free_to_discuss(Situation(state, tuple(discussed)), robot))
        refused = why_no_tour(state.costs_from(robot), adviser.at, free, adviser.energy)
        if refused is not None:
            return refused
        starts = {robot: TourStart(state.costs_from(robot), adviser.energy)}
        if self.planner not in PLANNING_ALONE:
            others = {other: start_of(state, discussed, other) for other in range(len(state.robots)) if other != robot}
            starts |= {other: start for other, start in others.items() if start is not None}
        tours = tours_sending_first(self.planner, costs, tuple(starts.values()), free, state.started.identify_cost)
        planned = tours[0].rooms[0]
        wrong = [room for room in possible_rooms(state, discussed, robot) if room != planned]
        stream = noise.key(state.started.seed, "adviser", str(state.started.game), str(robot))
        may_err = self.error_rate + self.confidence_spread * (2.0 * noise.uniform(stream, number, 2) - 1.0)
        errs = noise.uniform(stream, number, 0) < may_err and bool(wrong)
        room = wrong[int(noise.uniform(stream, number, 1) * len(wrong))] if errs else planned
        if self.error_rate > 0.0:
            reason = self.reason_by_cost(state.cost(robot, room))
        else:
            exact = self.planner in _EXACT and can_compare(free, starts)
            reason = self._reason(starts[robot].costs, room, free, dict(zip(starts, tours, strict=True)), robot, exact)
        confidence = None
        if self.says_confidence:
            calibrated = 1.0 - may_err if wrong else 1.0
            confidence = min(max(calibrated + self.confidence_bias, 0.0), 1.0)
        return Advice(room, reason, number, planned, errs, confidence)

    def reason_by_cost(self, cost: float) -> str:
        """Return a reason that is true for any room, as part of a sentence."""
        return self.texts.clause("scripted.reason_cost", energy=cost)

    def _reason(
        self, row: Sequence[float], room: Room, free: Collection[Room], tours: dict[int, Tour], robot: int, exact: bool
    ) -> str:
        """Return the reason for a robot's next room, as part of a sentence.

        Args:
            row: energy from the robot's position to every place.
            room: the robot's next room.
            free: remaining rooms.
            tours: planned tours, by robot.
            robot: the robot that gives the reason.
            exact: True if the tours are optimal. If False, the reason makes no claim about tours.
        """
        nearest = min(free, key=lambda other: (row[other.people], other))
        if row[room.people] <= row[nearest.people]:
            return self.texts.text("scripted.reason_nearest")
        taker = next((number for number, tour in tours.items() if nearest in tour.rooms), None)
        if taker is not None and taker != robot:
            return self.texts.clause("scripted.reason_taken", room=nearest, other=taker)
        if not exact:
            return self.reason_by_cost(row[room.people])
        if taker is None:
            return self.texts.clause("scripted.reason_more_rooms", room=nearest)
        return self.texts.clause("scripted.reason_round", room=nearest, place=room)


def possible_rooms(state: GameState, discussed: Sequence[Discussed], robot: int) -> list[Room]:
    """Return the rooms that a robot could suggest: free for discussion, and within the robot's energy."""
    free = free_to_discuss(Situation(state, tuple(discussed)), robot)
    return [room for room in free if isinstance(rules.move(state, robot, room), tuple)]


def start_of(state: GameState, discussed: Sequence[Discussed], number: int) -> TourStart | None:
    """Return the start of another robot's next move, or None if the participant cannot send it."""
    robot, costs, visit = state.robots[number], state.started.costs, state.started.identify_cost
    if rules.unable(state, number) or rules.commanded_by_other(state, number, Commander.PARTICIPANT):
        return None
    row, energy = state.costs_from(number), robot.energy
    talk = next((about.room for about in discussed if (about.robot, about.matter) == (number, "select-room")), None)
    if robot.bound_for is not None:
        row, energy = costs.rows[robot.bound_for.people], energy - visit
    elif talk is not None:
        row, energy = costs.rows[talk], energy - row[talk] - visit
    elif state.has_room(robot.at) and state.decider(robot.at) == number and not state.room(robot.at).is_decided:
        energy -= visit
    return TourStart(row, max(energy, 0.0))


def can_compare(rooms: Collection[Room], robots: Collection[object]) -> bool:
    """Return True if a comparison of all plans for these rooms and robots is fast enough for a waiting game."""
    return len(rooms) <= _MOST_ROOMS_COMPARED.get(len(robots), 12)


@lru_cache(maxsize=16)
def tours_sending_first(
    planner: TeamPlanner, costs: CostMatrix, starts: tuple[TourStart, ...], rooms: tuple[Room, ...], visit: float
) -> tuple[Tour, ...]:
    """Return the tours of a plan. If the first robot has energy for any room, the plan sends it to a room.

    Results are cached: a robot's suggestions and arguments use the same plan, and a wizard sees the advice in every
    tick.
    """
    searches = planner in _EXACT and not can_compare(rooms, starts)
    plan = searched_tours if searches else PLANNERS[planner]
    return plan(costs, starts, rooms, visit, sent=0)
