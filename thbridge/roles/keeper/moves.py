"""Moves of the robots in a game: orders to SimR, stopped robots, and rooms that were not reached."""

from thbridge.hunt.events import JournalEntry, MoveFailed, RobotArrived, RobotDeparted
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room
from thbridge.roles.shared.notices import MoveOrder


class TeamMoves:
    """Moves of a game's robots. Moves have numbers in the orders to SimR.

    Args:
        robots: size of the team.
    """

    def __init__(self, robots: int) -> None:
        # By robot: number of the latest move, and number of the latest ordered move.
        self._latest = [0] * robots
        self._ordered = [0] * robots
        self._departures = 0
        self._stopping: set[int] = set()

    def note(self, event: JournalEntry) -> None:
        """Process an event of the game."""
        match event:
            case RobotDeparted(robot=robot):
                self._departures += 1
                self._latest[robot] = self._departures
            case RobotArrived(robot=robot) | MoveFailed(robot=robot):
                self._stopping.discard(robot)

    def is_ordered(self, robot: int) -> bool:
        """Return True if SimR has the order for a robot's latest move."""
        return self._ordered[robot] == self._latest[robot]

    def stop(self, robot: int) -> None:
        """Stop a moving robot. The move ends when SimR reports the driven share."""
        self._stopping.add(robot)

    def is_stopping(self, robot: int) -> bool:
        """Return True if a robot is still moving after `stop`."""
        return robot in self._stopping

    def is_executing(self, state: GameState, robot: int, move: int) -> bool:
        """Return True if a robot is executing the move with this number."""
        return state.has_robot(robot) and state.robots[robot].bound_for is not None and self._latest[robot] == move

    def orders(self, state: GameState) -> tuple[MoveOrder | None, ...]:
        """Return the order for each robot, and mark the orders as sent."""
        self._ordered = list(self._latest)
        return tuple(
            None
            if robot.bound_for is None or number in self._stopping
            else MoveOrder(self._latest[number], robot.bound_for.people)
            for number, robot in enumerate(state.robots)
        )


class UnreachedRooms:
    """Rooms that robots recently failed to reach, and failures that robots have not mentioned yet."""

    def __init__(self) -> None:
        # By robot: rooms that the robot failed to reach since its last arrival in a room.
        self._rooms: dict[int, frozenset[Room]] = {}
        self._to_report: set[int] = set()

    def note(self, event: JournalEntry, state: GameState | None, moves: TeamMoves) -> None:
        """Process an event before it changes the state. After an arrival, a robot considers all rooms again."""
        if isinstance(event, RobotArrived):
            self._rooms.pop(event.robot, None)
        elif isinstance(event, MoveFailed) and state is not None and not moves.is_stopping(event.robot):
            room = state.robots[event.robot].bound_for
            if room is not None:
                self._rooms[event.robot] = self.of(event.robot) | {room}
                self._to_report.add(event.robot)

    def of(self, robot: int) -> frozenset[Room]:
        """Return the rooms that a robot has failed to reach."""
        return self._rooms.get(robot, frozenset())

    @property
    def to_report(self) -> list[int]:
        """Robots that failed to reach a room and have not mentioned this failure yet."""
        return sorted(self._to_report)

    def reported(self) -> None:
        """Remove all failures, because robots have mentioned them or will not mention them."""
        self._to_report.clear()
