"""SimR: the robots' program. It carries out the keeper's orders with a team of robots, and reports the results."""

from collections.abc import Sequence
from typing import assert_never

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Twist
from sim.inputs import CancelGoal, DriveManually, PlaceRobot, SendGoal, SetCharge, TeamInput
from sim.numerics import elementary
from sim.robot.navigator.goals import Goal
from sim.snapshot import TeamSnapshot
from thbridge.hunt.events import Condition
from thbridge.hunt.rooms import Room
from thbridge.hunt.seats import Seat
from thbridge.roles.shared.notices import (
    KEEPER,
    SIMR_NOTICES,
    MoveCosts,
    MoveOrder,
    Orders,
    RecordingPermission,
    RobotsReady,
    SimrNotice,
    Subscribe,
    TeamRejection,
    TeamStatus,
)
from thbridge.roles.shared.robot_requests import RobotRequest, Tuning
from thbridge.roles.shared.robots_role import RobotsRole
from thbridge.roles.shared.seat_programs import seat_of
from thbridge.roles.simr.controls import MANUAL_DRIVE_TICKS, RobotControls
from thbridge.roles.simr.game_moves import GameMap, MovePrices, MovesInProgress
from thbridge.roles.simr.pose_telemetry import TelemetryOptions, TelemetryPublisher
from thbridge.roles.simr.team import RobotTeam
from thbridge.text_protocol.values.dialect import Dialect
from thbridge.text_protocol.wire import canonical, legacy
from thbridge.text_protocol.wire.canonical import GotoPoint, MoveByHand, PoseQuery, decode_goto
from thbridge.text_protocol.wire.lines import TextCommand, TextMessage
from thbridge.text_protocol.wire.notice_format import encode_notice

STATUS_PERIOD = TICKS_PER_SECOND
"""Number of ticks between two statuses. A status is also sent if a move, a condition or a researcher changes."""

KEEPER_TIMEOUT = TICKS_PER_SECOND
"""Number of ticks for which a `%%goto` waits for a keeper. If the keeper sends no orders in this time, SimR obeys the
`%%goto` as in 2016."""

RESPONSE_TIMEOUT = 5 * TICKS_PER_SECOND
"""By default, a robot counts as silent after this number of ticks without observations."""

MANUAL_SPEEDS = {
    canonical.MoveDirection.FORWARD: (1.0, 0.0),
    canonical.MoveDirection.BACKWARD: (-1.0, 0.0),
    canonical.MoveDirection.WIDE_CLOCKWISE: (1.0, -1.0),
    canonical.MoveDirection.WIDE_ANTICLOCKWISE: (1.0, 1.0),
    canonical.MoveDirection.TURN_CLOCKWISE: (0.0, -1.0),
    canonical.MoveDirection.TURN_ANTICLOCKWISE: (0.0, 1.0),
}
"""Forward speed and turn rate for each direction, as shares of the full intensity, which is 0.5 m/s and 1 rad/s."""


class SimR(RobotsRole):
    """Role of the robots.

    SimR carries out the keeper's orders. Without a keeper (at the server of another program), it obeys `%%goto` as in
    2016. In both cases, it answers `%%where`, obeys `%%move`, and drives to points in meters.

    Args:
        robots: the team.
        game_map: rooms, start poses and costs.
        dialect: the interpretation of `%%goto` that is tried first.
        response_timeout: number of ticks without observations after which a robot counts as silent and its move fails.
        telemetry: options of pose telemetry.
        seats: seats of the game; empty for a game with one participant. In a game with several seats, lines of 2016
            have no effect, because they do not name their sender reliably. Only seats that see the map receive pose
            telemetry.

    Attributes:
        snapshot: the team after the last step, or None before the first step.
        rejection: reason why the keeper rejected these robots, or None.
    """

    name = legacy.SIMR
    snapshot: TeamSnapshot | None = None

    def __init__(
        self,
        robots: RobotTeam,
        game_map: GameMap,
        dialect: Dialect = Dialect.LEGACY_2016,
        response_timeout: int = RESPONSE_TIMEOUT,
        telemetry: TelemetryOptions | None = None,
        seats: Sequence[Seat] = (),
    ) -> None:
        self._seats = tuple(seats)
        self._team = robots
        self._controls = RobotControls(robots)
        self._game_map = game_map
        self._dialect = dialect
        self._response_timeout = response_timeout
        self._introduce = False
        self._inputs: list[TeamInput] = []
        self._moves = MovesInProgress(game_map.goals, robots.size)
        self._prices = MovePrices(game_map.travel, robots.size)
        self._conditions = (Condition.WELL,) * robots.size
        self._lost = [False] * robots.size
        self._researchers: tuple[str | None, ...] = (None,) * robots.size
        # The keeper's last orders, or None before the first orders.
        self._orders: Orders | None = None
        self._waiting: list[tuple[int, legacy.GotoRoom]] = []
        self._without_keeper = 0
        self._telemetry = TelemetryPublisher(self.name, telemetry or TelemetryOptions())
        self.rejection: str | None = None

    def connected(self) -> None:
        """Send a notice about the robots to the keeper in the next step."""
        self._introduce = True

    def ask(self, request: RobotRequest, researcher: str | None = None) -> None:
        """See `RobotsRole`."""
        self._controls.ask(request, researcher)

    def tuning(self, robot: int) -> Tuning | None:
        """Return a robot's parameters; see `RobotControls.tuning`."""
        return self._controls.tuning(robot)

    def step(self, tick: int, messages: Sequence[TextMessage]) -> list[TextMessage]:
        """Run one tick of the role and of the team; see `Role`."""
        outgoing: list[TextMessage] = []
        # The oldest inputs are first, so that newer inputs override them: restored goals, requests, orders of this
        # tick.
        resumed, self._inputs = self._inputs, []
        if self._introduce:
            self._introduce = False
            place, travel = self._game_map, self._game_map.travel
            from_starts = () if travel is None else tuple(travel.costs_from(start) for start in place.starts)
            ready = RobotsReady(place.name, self._team.size, place.costs, from_starts)
            outgoing.append(encode_notice(self.name, KEEPER, ready))
        for message in messages:
            outgoing += self._handle_message(tick, message)
        self._obey_without_keeper(tick)
        asked = self._controls.take_inputs(1 if self.snapshot is None else self.snapshot.tick + 1)
        self.snapshot = self._team.step([*resumed, *asked, *self._inputs])
        self._inputs.clear()
        self._controls.follow(self.snapshot)
        before = self._conditions, self._researchers, tuple(self._moves.results)
        silent = self._silent(self.snapshot)
        outgoing += self._follow_moves(self.snapshot, silent)
        for robot, output in self.snapshot.renewed.items():
            self._lost[robot] = output.lost
        self._conditions = tuple(
            Condition.SILENT if robot in silent else Condition.LOST if lost else Condition.WELL
            for robot, lost in enumerate(self._lost)
        )
        self._researchers = self._controls.researchers
        changed = before != (self._conditions, self._researchers, tuple(self._moves.results))
        if changed or tick % STATUS_PERIOD == 0:
            outgoing.append(encode_notice(self.name, KEEPER, self._status(self.snapshot)))
        if self._price(self.snapshot, silent) or changed or tick % STATUS_PERIOD == 0:
            outgoing += self._move_costs()
        return outgoing + self._telemetry.messages(tick, self.snapshot, self._conditions, self._moves.shares)

    # Messages to SimR

    def _handle_message(self, tick: int, message: TextMessage) -> list[TextMessage]:
        match message.command:
            case TextCommand.ERROR:
                self._handle_notice(tick, message.sender, SIMR_NOTICES.read(message))
            case _ if self._seats:
                pass
            case TextCommand.GOTO:
                goto = decode_goto(message, self._dialect, len(self._game_map.goals))
                if isinstance(goto, legacy.GotoRoom) and goto.robot < self._team.size:
                    self._waiting.append((tick, goto))
                elif isinstance(goto, GotoPoint) and self._is_free(goto.robot) and not self._is_judged(message):
                    self._go_to_point(goto)
            case TextCommand.WHERE:
                where = canonical.decode(message)
                if isinstance(where, PoseQuery) and 0 <= where.robot < self._team.size and self.snapshot is not None:
                    pose = self.snapshot.robots[where.robot].estimate.base_in_map
                    answer = canonical.PoseReport(where.robot, pose.x, pose.y, pose.theta)
                    return [canonical.encode(answer, self.name, message.sender)]
            case TextCommand.MOVE:
                move = canonical.decode(message)
                if isinstance(move, MoveByHand) and self._is_free(move.robot):
                    linear, angular = MANUAL_SPEEDS[move.drive]
                    share = move.intensity / 5.0
                    twist = Twist(0.5 * share * linear, share * angular)
                    self._inputs.append(DriveManually(move.robot, twist, MANUAL_DRIVE_TICKS))
        return []

    def _handle_notice(self, tick: int, sender: str, notice: SimrNotice | None) -> None:
        match notice:
            case Orders() | TeamRejection() if sender != KEEPER:
                pass  # Other programs do not command the team.
            case Orders():
                if self._can_follow(notice):
                    self._follow(notice)
            case Subscribe():
                seat = seat_of(sender, self._seats)
                if seat is not None:
                    self._telemetry.subscribe(sender, tick, with_poses=seat.sees_map)
            case TeamRejection(sentence):
                self.rejection = sentence
            case RecordingPermission() | None:
                pass  # The program that runs this role handles this notice.
            case _:
                assert_never(notice)

    def _can_follow(self, orders: Orders) -> bool:
        """Return True if orders match this team and map. Other orders are from a faulty sender and are ignored."""
        team, places = self._team.size, range(len(self._game_map.goals) + 1)
        return (
            orders.game > 0
            and len(orders.moves) == len(orders.energy) == len(orders.at) == team
            and (orders.poses is None or len(orders.poses) == team)
            and all(order is None or order.room in places[1:] for order in orders.moves)
            and all(place in places for place in orders.at)
        )

    def _follow(self, orders: Orders) -> None:
        """Start and stop moves as these orders require."""
        former, self._orders = self._orders, orders
        if former is None or former.game != orders.game:
            self._begin(orders, again=former is not None)
        for robot, order in enumerate(orders.moves):
            if order is not None and order.move != self._moves.last(robot):
                self._inputs.append(self._moves.go(robot, order))
            elif order is None and robot in self._moves:
                self._inputs.append(CancelGoal(robot))
        self._inputs += [SetCharge(robot, charge) for robot, charge in enumerate(orders.energy)]

    def _begin(self, orders: Orders, *, again: bool) -> None:
        """Place every robot for a new game, or for the open game after a restart of SimR."""
        self._waiting.clear()
        self._moves.restart()
        self._prices.restart()
        if orders.poses is not None:
            places = [Pose2(*pose) for pose in orders.poses]
        elif again or any(orders.at):
            starts, goals = self._game_map.starts, self._game_map.goals
            places = [goals[Room(room).wire] if room else starts[robot] for robot, room in enumerate(orders.at)]
        else:
            return
        for robot, pose in enumerate(places):
            self._inputs += [CancelGoal(robot), PlaceRobot(robot, pose)]

    def _obey_without_keeper(self, tick: int) -> None:
        """Obey lines that have waited for a keeper for the full timeout. If there is a keeper, drop these lines."""
        if self._orders is not None:
            self._waiting.clear()
        while self._waiting and tick - self._waiting[0][0] >= KEEPER_TIMEOUT:
            _, goto = self._waiting.pop(0)
            self._without_keeper += 1
            order = MoveOrder(self._without_keeper, Room.of_wire(goto.room).people)
            self._inputs.append(self._moves.go(goto.robot, order))

    def _is_free(self, robot: int) -> bool:
        """Return True if the robot has no move of the game and no other commander, so that a text line may drive it."""
        taken = () if self._orders is None else self._orders.taken
        return 0 <= robot < self._team.size and robot not in self._moves and robot not in taken

    def _is_judged(self, message: TextMessage) -> bool:
        """Return True if a line is from 2016 and there is a keeper, which decides on it and refuses unknown rooms."""
        return (
            self._orders is not None
            and self._dialect is Dialect.LEGACY_2016
            and isinstance(legacy.decode(message), legacy.GotoRoom)
        )

    def _go_to_point(self, goto: GotoPoint) -> None:
        if self.snapshot is None:
            return
        here = self.snapshot.robots[goto.robot].estimate.base_in_map
        heading = elementary.atan2(goto.y - here.y, goto.x - here.x) if goto.heading is None else goto.heading
        self._inputs.append(SendGoal(goto.robot, Goal(0, Pose2(goto.x, goto.y, heading))))

    # Messages of SimR

    def _follow_moves(self, snapshot: TeamSnapshot, silent: set[int]) -> list[TextMessage]:
        orders = () if self._orders is None else self._orders.moves
        stopped = [robot for robot, order in enumerate(orders) if order is None]
        lines, lost = self._moves.follow(snapshot, silent, stopped, self._controls.is_driven)
        self._inputs += lost
        return lines

    def _price(self, snapshot: TeamSnapshot, silent: set[int]) -> bool:
        """Update the prices for robots that have stopped at another position. Return True if there are new prices."""
        robots = range(self._team.size)
        moving = {robot for robot in robots if robot in self._moves or self._controls.is_driven(robot)}
        return self._prices.update(snapshot, moving | silent)

    def _move_costs(self) -> list[TextMessage]:
        costs = self._prices.costs
        if self._orders is None or costs is None:
            return []
        return [encode_notice(self.name, KEEPER, MoveCosts(self._orders.game, costs))]

    def _silent(self, snapshot: TeamSnapshot) -> set[int]:
        """Return the robots whose last observations are older than the timeout."""
        due = snapshot.tick - self._response_timeout
        # Simulated robots that live have observations in each tick.
        robots = range(self._team.size) if snapshot.world is None else snapshot.dead
        return {robot for robot in robots if snapshot.robots[robot].tick <= due}

    def _status(self, snapshot: TeamSnapshot) -> TeamStatus:
        if snapshot.world is None:
            poses = (output.estimate.base_in_map for output in snapshot.robots)
            places = tuple((pose.x, pose.y, pose.theta) for pose in poses)
        else:
            places = tuple((float(x), float(y), float(theta)) for x, y, theta in snapshot.world.poses)
        game = 0 if self._orders is None else self._orders.game
        return TeamStatus(game, places, tuple(self._moves.results), self._conditions, self._researchers)
