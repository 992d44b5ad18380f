"""The keeper's data about SimR and Hider: the last notices from and to these programs."""

from contextlib import suppress

from msgspec import structs

from thbridge.hunt import rules
from thbridge.hunt.codec import treasure_of
from thbridge.hunt.events import Commander, TreasuresHidden
from thbridge.hunt.game import GameState
from thbridge.hunt.refusals import RequestRefused
from thbridge.roles.keeper.open_game import OpenGame
from thbridge.roles.shared.notices import (
    HideRequest,
    HideTreasures,
    MoveCosts,
    Orders,
    RecordingPermission,
    RobotsReady,
    TeamStatus,
)
from thbridge.roles.shared.participant_rules import KeeperReason
from thbridge.roles.shared.view import SendRobot
from thbridge.text_protocol.wire.notice_format import kind_of


class ConnectedTeam:
    """Data about SimR: its robots, their poses, and the last orders.

    Args:
        game: the open game.

    Attributes:
        ready: the robots; None before SimR has joined.
    """

    def __init__(self, game: OpenGame) -> None:
        self._game = game
        self.ready: RobotsReady | None = None
        self._poses: tuple[tuple[float, float, float], ...] | None = None
        self._ordered: Orders | None = None
        # The last answer to SimR's question for consent; None if SimR has not asked.
        self._permission: RecordingPermission | None = None

    @property
    def map(self) -> str | None:
        """Name of the robots' map, or None if it is unknown."""
        return None if self.ready is None else self.ready.map

    @property
    def from_starts(self) -> tuple[tuple[float | None, ...], ...]:
        """Energy from each robot's start to each place; empty if unknown."""
        return () if self.ready is None else self.ready.from_starts

    def begin(self, game: int) -> None:
        """Begin a game. Set the costs of moves from the start poses."""
        self.price(MoveCosts(game, self.from_starts))
        self._poses = None

    def take_status(self, status: TeamStatus) -> None:
        """Process a status: the robots' poses and the results of ended moves."""
        game = self._game
        state = game.state
        if state is None or status.game != state.started.game or state.ended is not None:
            return
        if {len(status.poses), len(status.results), len(status.conditions)} != {len(state.robots)}:
            return
        self._poses = status.poses
        for robot, result in enumerate(status.results):
            if result is None or game.state is None or not game.moves.is_executing(game.state, robot, result.move):
                continue
            bound_for = game.state.robots[robot].bound_for
            if result.arrived and bound_for is not None:
                game.apply_ruling("Arrived", rules.arrive(game.state, robot, bound_for))
            else:
                stopping = game.moves.is_stopping(robot)
                game.apply_ruling("Failed", rules.fail(game.state, robot, result.sentence, result.share))
                if not stopping:
                    game.refuse(kind_of(SendRobot), RequestRefused(KeeperReason.NO_PATH, result.sentence), robot)
        for robot, condition in enumerate(status.conditions):
            if game.state is not None:
                game.apply_ruling("Reported", rules.report(game.state, robot, condition))
        for robot, researcher in enumerate(status.researchers):
            if game.state is not None:
                game.apply_ruling("Commanded", rules.intervene(game.state, robot, researcher))

    def price(self, priced: MoveCosts) -> None:
        """Process the costs of moves from the robots' present positions."""
        state = self._game.state
        if state is None or priced.game != state.started.game or len(priced.costs) != len(state.robots):
            return
        for robot, costs in enumerate(priced.costs):
            if costs and state.robots[robot].bound_for is None:
                self._game.apply_ruling("Priced", rules.price(state, robot, costs))

    def orders(self, state: GameState, *, with_poses: bool) -> Orders | None:
        """Return the orders for SimR, optionally with the robots' poses, or None if SimR already has these orders."""
        orders = Orders(
            game=state.started.game,
            moves=self._game.moves.orders(state),
            energy=tuple(robot.energy for robot in state.robots),
            at=tuple(robot.at.people for robot in state.robots),
            poses=self._poses if with_poses else None,
            taken=tuple(
                number for number, robot in enumerate(state.robots) if robot.command.by is not Commander.PARTICIPANT
            ),
        )
        if not with_poses and self._ordered is not None and structs.replace(self._ordered, poses=None) == orders:
            return None
        self._ordered = orders
        return orders

    def permission(self, *, recordable: bool) -> RecordingPermission:
        """Return the answer to SimR's question about permission to record the participant."""
        self._permission = RecordingPermission(recordable)
        return self._permission

    def changed_permission(self, *, recordable: bool) -> RecordingPermission | None:
        """Return a changed answer to SimR's question. Return None if it is unchanged or SimR has not asked."""
        known = self._permission
        return None if known in {None, RecordingPermission(recordable)} else self.permission(recordable=recordable)


class ConnectedHider:
    """Data about Hider.

    Args:
        game: the open game.

    Attributes:
        ready: True if Hider has joined.
    """

    def __init__(self, game: OpenGame) -> None:
        self._game = game
        self.ready = False

    def awaits_treasures(self, state: GameState) -> bool:
        """Return True if Hider has joined but has not hidden the treasures yet."""
        return self.ready and state.treasures is None

    def request(self) -> HideRequest | None:
        """Return the request to hide the treasures, or None if there is no need to hide treasures."""
        state = self._game.state
        if state is None or not self.awaits_treasures(state) or state.ended is not None:
            return None
        return HideRequest(state.started.game, len(state.rooms))

    def hide(self, hidden: HideTreasures) -> None:
        """Record the treasures that Hider has hidden."""
        state = self._game.state
        fresh = state is not None and state.treasures is None and state.started.game == hidden.game
        if state is None or not fresh or len(hidden.treasures) != len(state.rooms):
            return
        with suppress(ValueError):
            self._game.record((TreasuresHidden(tuple(treasure_of(fields) for fields in hidden.treasures)),))
