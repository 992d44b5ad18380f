"""Pilot of one robot: requests of ground stations become moves of the game, or goals and manual driving beside it.

A point in a room is a move of the game: its rules hold, energy is paid, the treasure is sensed. Any other point, and
one in the room where the robot stands, is a goal of its navigator that the game does not notice.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OCCUPIED, UNKNOWN
from sim.common.observations import Twist
from sim.common.robot_numbers import robot_name
from sim.common.traversability import TraversabilityMap, inside
from sim.inputs import CancelGoal, DriveManually, SendGoal
from sim.numerics import elementary
from sim.team import TeamSnapshot
from thbridge.hunt import rules
from thbridge.hunt.events import Commander, CommanderChanged
from thbridge.hunt.game import CommandHolder, GameState, apply
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.mavlink.role.speed_limit import SpeedLimit
from thbridge.mavlink.role.station_texts import game_texts, handback_texts
from thbridge.mavlink.role.trips import TripStage, VehicleTrip, advanced, is_responding
from thbridge.mavlink.values.vehicle_interface import (
    DenialKind,
    Denied,
    HelmLeg,
    LegState,
    ParameterSettings,
    RobotReadings,
    Station,
    Target,
)
from thbridge.roles.shared import failure_reasons as reasons
from thbridge.roles.shared.notices import RoomOutline
from thbridge.roles.shared.robot_requests import (
    ReleaseCommand,
    Request,
    SetParameters,
    StationIdentify,
    StationLeave,
    StationSend,
    StationStop,
    StationTakePicture,
    TakeCommand,
)
from thbridge.roles.simr.controls import MANUAL_DRIVE_TICKS


@dataclass(frozen=True, slots=True)
class GameSetup:
    """Facts about the game that all pilots of a team know before it begins.

    Attributes:
        floor: of the map.
        rooms: on the map.
        names: possible names of treasures, in alphabetical order.
        energy: of each robot at the start.
        plans_end_apart: True when plans may end apart from a goal that is out of reach (`default_tolerance`).
    """

    floor: TraversabilityMap
    rooms: tuple[RoomOutline, ...]
    names: tuple[str, ...]
    energy: float
    plans_end_apart: bool = False

    def room_at(self, x: float, y: float) -> RoomOutline | None:
        """Return the room that contains a point of the map, or None."""
        xs, ys = np.array([x]), np.array([y])
        return next((room for room in self.rooms if inside(room.region, xs, ys)[0]), None)


class Pilot:
    """The `VehicleInterface` of one robot.

    Args:
        robot: its index in the team, from 0.
        setup: of the game.
        start: start pose, map frame.
        speeds: its speed limit.
        parameters: as MAVLink has them.
        ask: takes requests to robots and game for the next tick; they follow from frames, and so are no inputs.
    """

    def __init__(
        self,
        robot: int,
        setup: GameSetup,
        start: Pose2,
        speed_limit: SpeedLimit,
        parameters: ParameterSettings,
        ask: Callable[[Request], None],
    ) -> None:
        self.parameters = parameters
        self._robot = robot
        self._setup = setup
        self._start = start
        self._speed_limit = speed_limit
        self._ask = ask
        self._legs = 0
        self._trip: VehicleTrip | None = None
        self._snapshot: TeamSnapshot | None = None
        self._game: GameState | None = None
        # Requests to the game since the last tick, and whether its current move has to end.
        self._new_holder: CommandHolder | None = None
        self._sent = False
        self._stopping = False

    # Command

    def take(self, station: Station) -> Denied | None:
        """See `VehicleInterface`; a robot that does not respond cannot be taken."""
        if self._game is None or self._snapshot is None:
            return _NO_GAME
        if not is_responding(self._snapshot, self._robot):
            return Denied(reasons.unresponsive_sentence(self._robot))
        self._give(TakeCommand(self._robot, str(station)), CommandHolder(Commander.GROUND_STATION, str(station)))
        return None

    def release(self) -> None:
        """See `VehicleInterface`."""
        self._give(ReleaseCommand(self._robot), CommandHolder())

    def _give(self, request: TakeCommand | ReleaseCommand, command: CommandHolder) -> None:
        self._ask(request)
        self._new_holder = command

    # Driving

    def go_to(self, target: Target) -> int | Denied:
        """See `VehicleInterface`; the game's rules and the map judge at once, the navigator when the robot sets out."""
        if not all(map(math.isfinite, (target.x, target.y, target.heading or 0.0))):
            return Denied("That is no point of a map.")
        state = self._able()
        if isinstance(state, Denied):
            return state
        robot, outline = state.robots[self._robot], self._setup.room_at(target.x, target.y)
        room = None if outline is None else Room(outline.room)
        if outline is None or room is None or (robot.bound_for is None and robot.at == room):
            if not self._is_here(target) and (denied := self._out_of_reach(target.x, target.y)) is not None:
                return denied
            trip = self._trip_to(self._pose_at(target), None)
        else:
            trip = self._trip_to(Pose2(*outline.goal), room)
            if robot.bound_for == room and not self._stopping:
                trip = replace(trip, stage=TripStage.GOING)
            elif isinstance(ruling := self._judge(state, room), RequestRefused):
                return Denied(ruling.sentence, is_done=ruling.reason == rules.RuleReason.ALREADY_VISITED)
        self._legs += 1
        self._trip = trip
        if trip.stage is TripStage.WAITING:
            self._trip = self._set_out(trip, state)
        return trip.leg.number

    def halt(self) -> None:
        """See `VehicleInterface`."""
        self._give_up(reasons.STOPPED)
        self._stop_move()
        self._ask(CancelGoal(self._robot))

    def drive(self, twist: Twist) -> Denied | None:
        """See `VehicleInterface`; it aborts a leg or a move of the game in progress."""
        state = self._able()
        if isinstance(state, Denied):
            return state
        self._give_up(reasons.BY_HAND)
        self._stop_move()
        self._ask(DriveManually(self._robot, self._speed_limit.bounded(twist), MANUAL_DRIVE_TICKS))
        return None

    def fastest(self) -> Twist:
        """See `VehicleInterface`."""
        return self._speed_limit.fastest()

    def limit_speed(self, speed: float) -> Denied | None:
        """See `VehicleInterface`; a robot never drives faster than the study allows."""
        values = self._speed_limit.limit(speed)
        if isinstance(values, Denied):
            return values
        self._ask(SetParameters(self._robot, values))
        return None

    def start(self) -> Pose2:
        """See `VehicleInterface`."""
        return self._start

    def misplaced(self, x: float, y: float) -> Denied | None:
        """See `VehicleInterface`; with the sentence of a navigator that fails for the same reason."""
        grid = self._setup.floor.grid
        row, col = grid.cell_of(x, y)
        if not grid.contains(row, col):
            axis: Literal["x", "y"] = "x" if 0 <= row < grid.rows else "y"
            return Denied(reasons.failure_sentence(self._robot, "goal_outside"), axis=axis)
        if grid.cells[row, col] == UNKNOWN:
            return Denied(reasons.unknown_place_sentence(self._robot))
        if self._is_at_wall(row, col):
            return Denied(reasons.failure_sentence(self._robot, "goal_occupied"))
        return None

    def _is_at_wall(self, row: int, col: int) -> bool:
        """Return True for a cell in a wall, too near to one, or at the map's rim; the unknown is no wall."""
        floor = self._setup.floor
        grid, reach = floor.grid, floor.inscribed / floor.grid.resolution
        if not (0 < row < grid.rows - 1 and 0 < col < grid.cols - 1):
            return True
        cells = math.ceil(reach)
        top, left = max(0, row - cells), max(0, col - cells)
        around = grid.cells[top : row + cells + 1, left : col + cells + 1]
        away = np.argwhere(around == OCCUPIED) - (row - top, col - left)
        return bool((np.square(away).sum(axis=1) <= reach * reach).any())

    def unreachable(self, x: float, y: float) -> Denied | None:
        """See `VehicleInterface`."""
        return None if self._setup.room_at(x, y) is not None else self._out_of_reach(x, y)

    def _out_of_reach(self, x: float, y: float) -> Denied | None:
        return None if self._setup.plans_end_apart else self.misplaced(x, y)

    def _is_here(self, target: Target) -> bool:
        """Return True for a point in the robot's own cell: it is there, whatever the map has."""
        grid, here = self._setup.floor.grid, self._here()
        return grid.cell_of(target.x, target.y) == grid.cell_of(here.x, here.y)

    # Treasures

    def photograph(self) -> Denied | None:
        """See `VehicleInterface`."""
        return self._about_treasure(StationTakePicture(self._robot), rules.picture)

    def identify(self, number: int) -> Denied | None:
        """See `VehicleInterface`."""
        names = self._setup.names
        if not 1 <= number <= len(names):
            return Denied(f"Treasures have {len(names)} names, numbered from 1.")
        name = names[number - 1]
        return self._about_treasure(
            StationIdentify(self._robot, name), lambda state, at: rules.identify(state, at, name)
        )

    def leave(self) -> Denied | None:
        """See `VehicleInterface`."""
        return self._about_treasure(StationLeave(self._robot), rules.leave)

    def _about_treasure(self, request: Request, rule: Callable[[GameState, Room], rules.Ruling]) -> Denied | None:
        state = self._able()
        if isinstance(state, Denied):
            return state
        ruling = rule(state, state.robots[self._robot].at)
        if isinstance(ruling, RequestRefused):
            return Denied(ruling.sentence)
        self._ask(request)
        return None

    # The tick

    def follow(self, snapshot: TeamSnapshot, game: GameState | None) -> RobotReadings:
        """Update the trip after a tick, and return the robot's readings."""
        news = () if game is None else tuple(game_texts(self._robot, self._game, game))
        asked = () if game is None else tuple(handback_texts(self._robot, self._game, game))
        self._snapshot, self._game, self._new_holder, self._sent = snapshot, game, None, False
        if game is not None:
            self._stopping = self._stopping and game.robots[self._robot].bound_for is not None
            if self._stopping:
                self._ask(StationStop(self._robot))
            if self._trip is not None and self._trip.under_way:
                trip = advanced(self._trip, snapshot, game, self._robot)
                self._trip = self._set_out(trip, game) if trip.stage is TripStage.WAITING else trip
        return replace(self._readings(snapshot, game), announcements=news, participant_requests=asked)

    def _set_out(self, trip: VehicleTrip, state: GameState) -> VehicleTrip:
        """Request a trip, unless a move of the game has to end first.

        A return home outlives the command of a station that was lost, until somebody else sends the robot elsewhere.
        """
        mover = state.robots[self._robot]
        if self._sent or mover.bound_for is not None:
            if not self._stopping:
                if mover.holder.by is not Commander.GROUND_STATION:
                    return trip.failed(reasons.ELSEWHERE)
                self._stop_move()
            return trip
        if trip.room is None:
            if mover.intervention is not None:
                return trip.failed(reasons.ELSEWHERE)
            self._ask(SendGoal(self._robot, trip.goal))
            return replace(trip, stage=TripStage.GOING)
        ruling = rules.move(state, self._robot, trip.room, Commander.GROUND_STATION)
        if isinstance(ruling, RequestRefused):
            return trip.failed(ruling.sentence)
        self._ask(StationSend(self._robot, trip.room.people))
        self._sent = True
        return replace(trip, stage=TripStage.ASKED)

    def _readings(self, snapshot: TeamSnapshot, game: GameState | None) -> RobotReadings:
        output = snapshot.robots[self._robot]
        robot = None if game is None else game.robots[self._robot]
        holder = CommandHolder() if robot is None else robot.holder
        goal, responsive = output.navigation.goal, is_responding(snapshot, self._robot)
        return RobotReadings(
            base_in_map=output.estimate.base_in_map,
            twist=output.observations.odometry.twist,
            goal_in_map=None if goal is None else goal.base_in_map,
            energy=self._setup.energy if robot is None else robot.energy,
            capacity=self._setup.energy if game is None else game.started.energy,
            responsive=responsive,
            lost=output.estimate.lost,
            under_way=responsive and goal is not None,
            commander=holder.name if holder.by is Commander.GROUND_STATION else None,
            commanded_by=_commander_text(CommandHolder() if robot is None else robot.command),
            leg=None if self._trip is None else self._trip.leg,
        )

    # Conditions

    def _able(self) -> GameState | Denied:
        """Return the game as it will be after all requests so far, or the reason why no station can move the robot."""
        if self._game is None or self._snapshot is None:
            return _NO_GAME
        state = self._game
        if self._new_holder is not None:
            state = apply(state, CommanderChanged(self._robot, self._new_holder.by, self._new_holder.name))
        robot = state.robots[self._robot]
        if robot.is_silent or not is_responding(self._snapshot, self._robot):
            return Denied(reasons.unresponsive_sentence(self._robot))
        refused = rules.commanded_by_other(state, self._robot, Commander.GROUND_STATION)
        if refused is not None:
            intervenes = robot.command.by is Commander.RESEARCHER
            return Denied(refused.sentence, DenialKind.NOT_NOW if intervenes else DenialKind.DENIED)
        if robot.is_blocked:
            return Denied(f"{robot_name(self._robot).capitalize()} has no energy left.")
        return state

    def _judge(self, state: GameState, room: Room) -> rules.Ruling:
        """Return the rules' verdict on a move; a moving robot is judged as stopped, because it is stopped first."""
        back = rules.fail(state, self._robot, "", 0.0)
        for event in () if isinstance(back, RequestRefused) else back:
            state = apply(state, event)
        return rules.move(state, self._robot, room, Commander.GROUND_STATION)

    def _trip_to(self, target: Pose2, room: Room | None) -> VehicleTrip:
        return VehicleTrip(HelmLeg(self._legs + 1, LegState.UNDER_WAY, self._here().distance(target)), target, room)

    def _pose_at(self, target: Target) -> Pose2:
        """Return the goal pose; without a heading the direction from here to the target is used."""
        here, heading = self._here(), target.heading
        ahead = elementary.atan2(target.y - here.y, target.x - here.x)
        return Pose2(target.x, target.y, ahead if heading is None else heading)

    def _here(self) -> Pose2:
        return self._start if self._snapshot is None else self._snapshot.robots[self._robot].estimate.base_in_map

    def _give_up(self, reason: str) -> None:
        """Abort the leg in progress, if any."""
        if self._trip is not None and self._trip.under_way:
            self._trip = self._trip.failed(reason)

    def _stop_move(self) -> None:
        """Stop the game's current move, or the one just requested; it takes some ticks, and is requested until then."""
        under_way = self._game is not None and self._game.robots[self._robot].bound_for is not None
        if under_way:
            self._ask(StationStop(self._robot))
        self._stopping = under_way or self._sent


def _commander_text(command: CommandHolder) -> str:
    """Return the name of a commander, without an article."""
    return command.name if command.by is Commander.GROUND_STATION else command.by.value


_NO_GAME = Denied("The game has not begun yet.", DenialKind.NOT_NOW)
