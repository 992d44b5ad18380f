"""Program for the robots in trials that play a game without simulating robots."""

from collections.abc import Sequence

from thbridge.hunt.events import Condition
from thbridge.hunt.rooms import Room
from thbridge.roles.shared.notices import (
    KEEPER,
    SIMR_NOTICES,
    MoveOrder,
    MoveResult,
    Orders,
    RobotsReady,
    TeamRejection,
    TeamStatus,
)
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import encode_notice


class Puppets:
    """Robots without positions, for which each move takes the same time.

    Args:
        robots: number of robots.
        costs: energy of each move, by the numbers of the places: 0 for the corridor, 1 and more for rooms.
        ticks: duration of a move in ticks.
        place: name of the map.

    Attributes:
        stuck: indices of robots that find no path.
        mute: True to send no line when a robot has reached a room.
        conditions: conditions of each robot.
        researchers: for each robot, the name of the researcher who commands it, or None.
        unfit: reason why the keeper has rejected the team.
        orders: all orders of the keeper so far.
    """

    name = legacy.SIMR

    def __init__(
        self, robots: int, costs: tuple[tuple[float | None, ...], ...], ticks: int = 10, place: str = "stage"
    ) -> None:
        self.robots = robots
        self.place = place
        self.costs = costs
        self.ticks = ticks
        self.stuck: set[int] = set()
        self.unfit: str | None = None
        self.mute = False
        self.conditions = [Condition.WELL] * robots
        self.researchers: tuple[str | None, ...] = ()
        self.orders: list[Orders] = []
        self._introduce = False
        self._moves: dict[int, tuple[MoveOrder, int]] = {}
        self._results: list[MoveResult | None] = [None] * robots
        self._game = 0
        self._recalled = False

    def connected(self) -> None:
        """Introduce the team in the next step."""
        self._introduce = True

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Run one tick; see `Role`."""
        said: list[TextMessage] = []
        if self._introduce:
            self._introduce = False
            said.append(encode_notice(self.name, KEEPER, RobotsReady(self.place, self.robots, self.costs)))
        for message in messages:
            match SIMR_NOTICES.read(message):
                case Orders(moves=moves) as orders if len(moves) == self.robots:
                    self._follow(orders, tick)
                case TeamRejection(sentence):
                    self.unfit = sentence
        ended = [(robot, order) for robot, (order, due) in self._moves.items() if due <= tick]
        for robot, order in ended:
            del self._moves[robot]
            there = robot not in self.stuck
            self._results[robot] = MoveResult(order.move, there, "" if there else "There is no way.", 0.5)
            if there and not self.mute:
                said.append(legacy.RoomReached(robot, Room(order.room).wire).message())
        if ended or self._recalled or tick % 50 == 0:
            self._recalled = False
            poses = tuple((float(robot), 0.0, 0.0) for robot in range(self.robots))
            status = TeamStatus(self._game, poses, tuple(self._results), tuple(self.conditions), self.researchers)
            said.append(encode_notice(self.name, KEEPER, status))
        return said

    def _follow(self, orders: Orders, tick: int) -> None:
        self.orders.append(orders)
        self._game = orders.game
        for robot, order in enumerate(orders.moves):
            known = self._moves.get(robot)
            last = self._results[robot]
            if (
                order is not None
                and order.room > 0
                and (known is None or known[0] != order)
                and (last is None or last.move != order.move)
            ):
                self._moves[robot] = (order, tick + self.ticks)
                self._results[robot] = None
            elif order is None and known is not None:
                del self._moves[robot]
                self._results[robot] = MoveResult(known[0].move, False, "It was called back.", 0.5)
                self._recalled = True
