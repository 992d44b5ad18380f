"""Moves of the game in SimR: goals of robots, results, and the costs of further moves."""

from collections.abc import Callable, Collection
from dataclasses import dataclass

from sim.common.geometry import Pose2
from sim.inputs import SendGoal
from sim.numerics import elementary
from sim.robot.navigator.goals import Goal, GoalReached, NoPath
from sim.snapshot import TeamSnapshot
from thbridge.hunt.rooms import Room
from thbridge.roles.shared import failure_reasons as reasons
from thbridge.roles.shared.notices import MoveOrder, MoveResult
from thbridge.roles.simr.travel_times import TravelTimes
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage

PRICED_DISTANCE = 0.5
"""A robot's moves are priced again if it has moved by this distance, meters. At rest, the estimate of the pose drifts a
little."""


@dataclass(frozen=True, slots=True)
class GameMap:
    """Data of the game's map for SimR.

    Attributes:
        name: name of the map.
        goals: goal pose of each room, in order.
        starts: start pose of each robot.
        costs: energy of moves between places, by number (0 is the corridor, rooms start at 1). None if there is no
            move.
        travel: travel times from all other places. If None, the costs of the corridor apply there.
    """

    name: str
    goals: tuple[Pose2, ...]
    starts: tuple[Pose2, ...]
    costs: tuple[tuple[float | None, ...], ...]
    travel: TravelTimes | None = None


@dataclass(slots=True)
class _Move:
    """A move in progress.

    Attributes:
        order: the keeper's order.
        goal: goal of the robot.
        has_goal: True if the robot's navigator had this goal after its last step.
        length: length of the longest plan, meters; 0 before the first plan.
        remaining: remaining length of the path, meters.
    """

    order: MoveOrder
    goal: Goal
    has_goal: bool = False
    length: float = 0.0
    remaining: float = 0.0

    def share(self) -> float:
        return 1.0 - self.remaining / self.length if self.length > 0.0 else 0.0


class MovesInProgress:
    """Moves in progress, and the results of the robots' last moves.

    Args:
        goals: goal pose of each room, in order.
        robots: number of robots.

    Attributes:
        results: result of each robot's last move. None during a move and before the first move.
    """

    def __init__(self, goals: tuple[Pose2, ...], robots: int) -> None:
        self._goals = goals
        self._moves: dict[int, _Move] = {}
        self.results: list[MoveResult | None] = [None] * robots

    def __contains__(self, robot: int) -> bool:
        """Return True if a robot is carrying out a move of the game."""
        return robot in self._moves

    @property
    def shares(self) -> dict[int, float]:
        """For each robot with a move in progress: driven share of its path."""
        return {robot: move.share() for robot, move in self._moves.items()}

    def restart(self) -> None:
        """Remove all moves and results."""
        self._moves.clear()
        self.results = [None] * len(self.results)

    def go(self, robot: int, order: MoveOrder) -> SendGoal:
        """Begin a move. Return the goal for the robot."""
        self.results[robot] = None
        goal = Goal(order.move, self._goals[Room(order.room).wire])
        self._moves[robot] = _Move(order, goal)
        return SendGoal(robot, goal)

    def last(self, robot: int) -> int:
        """Return the number of the robot's present move or, at rest, of its last move. 0 before the first move."""
        move, result = self._moves.get(robot), self.results[robot]
        if move is not None:
            return move.order.move
        return 0 if result is None else result.move

    def follow(
        self,
        snapshot: TeamSnapshot,
        silent: Collection[int],
        stopped: Collection[int],
        is_driven: Callable[[int], bool],
    ) -> tuple[list[TextMessage], list[SendGoal]]:
        """Update the moves after a step of the team.

        Args:
            snapshot: snapshot of the team.
            silent: robots that do not respond.
            stopped: robots that must stand still, because the keeper has ordered this.
            is_driven: function that returns True for a robot that is driven by hand.

        Returns:
            The lines of 2016 about reached rooms. And goals that robots have lost, which must be sent again.
        """
        lines: list[TextMessage] = []
        lost: list[SendGoal] = []
        renewed = snapshot.renewed
        for robot in sorted(self._moves):
            move = self._moves[robot]
            if move.has_goal and robot not in renewed and robot not in silent:
                continue  # The robot drives on.
            output = snapshot.robots[robot]
            navigation, goal = output.navigation, move.goal
            # Most often, they are the same object, and comparing poses takes time.
            move.has_goal = navigation.goal is goal or navigation.goal == goal
            if move.has_goal and navigation.state == "controlling":
                move.remaining = navigation.remaining
                move.length = max(move.length, move.remaining)
            result = navigation.result
            if robot in silent:
                self._fail(robot, move, reasons.unresponsive_sentence(robot))
            elif result is not None and result.goal != goal:
                pass  # This is the result of an earlier goal, or of a goal that is not from the game.
            elif isinstance(result, GoalReached):
                del self._moves[robot]
                self.results[robot] = MoveResult(move.order.move, True, "", 1.0)
                lines.append(legacy.RoomReached(robot, Room(move.order.room).wire).message())
            elif isinstance(result, NoPath):
                self._fail(robot, move, reasons.failure_sentence(robot, result.reason))
            elif navigation.goal is None and output.tick == snapshot.tick:
                if robot in stopped:
                    self._fail(robot, move, reasons.CALLED_BACK)
                elif not is_driven(robot):
                    # The robot's navigator has lost the goal, because the robot was dead, driven by hand, or had
                    # another goal.
                    lost.append(SendGoal(robot, goal))
        return lines, lost

    def _fail(self, robot: int, move: _Move, sentence: str) -> None:
        del self._moves[robot]
        self.results[robot] = MoveResult(move.order.move, False, sentence, move.share())


class MovePrices:
    """Prices of moves from the robots' present positions. They are updated if a robot stops at another position.

    Args:
        travel: travel times from all places. If None, moves are not priced.
        robots: number of robots.
    """

    def __init__(self, travel: TravelTimes | None, robots: int) -> None:
        self._travel = travel
        # By robot: position for which its moves were priced, and the costs of the moves.
        self._priced: list[tuple[Pose2, tuple[float | None, ...]] | None] = [None] * robots

    def restart(self) -> None:
        """Remove all prices."""
        self._priced = [None] * len(self._priced)

    def update(self, snapshot: TeamSnapshot, busy: Collection[int]) -> bool:
        """Update the prices for robots that have stopped at another position. Return True if there are new prices.

        Args:
            snapshot: snapshot of the team.
            busy: robots that are moving or do not respond.
        """
        if self._travel is None:
            return False
        changed = False
        for robot, output in enumerate(snapshot.robots):
            if robot in busy or output.navigation.goal is not None or output.lost:
                continue
            here, priced = output.estimate.base_in_map, self._priced[robot]
            if priced is None or elementary.hypot(here.x - priced[0].x, here.y - priced[0].y) > PRICED_DISTANCE:
                self._priced[robot] = here, self._travel.costs_from(here)
                changed = True
        return changed

    @property
    def costs(self) -> tuple[tuple[float | None, ...], ...] | None:
        """Costs of each robot's moves, empty if they are unknown. None if they are unknown for all robots."""
        if not any(self._priced):
            return None
        return tuple(() if priced is None else priced[1] for priced in self._priced)
