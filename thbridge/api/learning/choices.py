"""Choices of agents in a state of the game: the robots that are ready, and the rooms for each robot."""

from thbridge.api.learning.observation import Mask, action_masks
from thbridge.api.learning.treasure_rule import TreasureRule
from thbridge.hunt.events import Commander
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room
from thbridge.hunt.rules import affordable


class RobotChoices:
    """Choices for the robots of a game, computed only when the state of the game has changed.

    Args:
        rule: rule that decides about treasures.
        rooms: number of rooms.
    """

    def __init__(self, rule: TreasureRule, rooms: int) -> None:
        self._rule = rule
        self._number = rooms
        self._judged: GameState | None = None
        self._ready: list[bool] = []
        self._rooms: list[tuple[Room, ...]] = []
        self._masks: Mask | None = None

    def ready(self, game: GameState) -> list[bool]:
        """Return one flag per robot: True if the robot can be sent to a room."""
        self._judge(game)
        return self._ready

    def rooms(self, game: GameState) -> list[tuple[Room, ...]]:
        """Return the rooms to which each robot can be sent."""
        self._judge(game)
        return self._rooms

    def masks(self, game: GameState) -> Mask:
        """Return the masks of all agents' actions."""
        self._judge(game)
        if self._masks is None:
            self._masks = action_masks(self._rooms, self._number)
        return self._masks

    def is_ready(self, game: GameState, robot: int) -> bool:
        """Return True if a robot can be sent: it is at rest, can drive, and has no undecided treasure in its room."""
        state = game.robots[robot]
        return (
            state.bound_for is None
            and not state.is_blocked
            and not state.is_silent
            and game.ended is None
            and state.command.by is Commander.GROUND_STATION
            and self._rule.request(game, robot) is None
        )

    def _judge(self, game: GameState) -> None:
        if game is not self._judged:
            self._judged = game
            self._ready = [self.is_ready(game, robot) for robot in range(len(game.robots))]
            self._rooms = [affordable(game, robot) if ready else () for robot, ready in enumerate(self._ready)]
            self._masks = None
