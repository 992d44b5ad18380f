"""Pilot of one robot. It converts requests of ground stations to moves of the game, or to driving outside the game.

A point in a room is a move of the game: the rules apply, the move costs energy, and the robot senses the treasure. A
point outside rooms, or in the room where the robot stands, is a goal of the navigator and does not affect the game.
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
from sim.inputs import CancelGoal, DriveManually
from sim.numerics import elementary
from sim.snapshot import TeamSnapshot
from thbridge.hunt import rules
from thbridge.hunt.events import Commander, CommanderChanged
from thbridge.hunt.game import CommandHolder, GameState, apply
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room
from thbridge.mavlink.role.speed_limit import SpeedLimit
from thbridge.mavlink.role.station_texts import game_texts, handback_texts
from thbridge.mavlink.role.trips import TripDispatcher, is_responding
from thbridge.mavlink.values.vehicle_interface import (
    PARTICIPANT,
    DenialKind,
    Denied,
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
    StationTakePicture,
    TakeCommand,
)
from thbridge.roles.simr.controls import MANUAL_DRIVE_TICKS


@dataclass(frozen=True, slots=True)
class GameSetup:
    """Facts about the game that all pilots of a team need before the game starts.

    Attributes:
        floor: traversability of the map.
        rooms: rooms on the map.
        names: possible names of treasures, in alphabetical order.
        energy: energy of each robot at the start.
        plans_end_apart: True if a plan may end near a goal that cannot be reached (`default_tolerance`).
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

    def misplaced(self, robot: int, x: float, y: float) -> Denied | None:
        """Return a denial if a robot can never stand at a point of the map. Its sentence is a navigator's sentence."""
        grid = self.floor.grid
        row, col = grid.cell_of(x, y)
        if not grid.contains(row, col):
            axis: Literal["x", "y"] = "x" if 0 <= row < grid.rows else "y"
            return Denied(reasons.failure_sentence(robot, "goal_outside"), axis=axis)
        if grid.cells[row, col] == UNKNOWN:
            return Denied(reasons.unknown_place_sentence(robot))
        if _is_at_wall(self.floor, row, col):
            return Denied(reasons.failure_sentence(robot, "goal_occupied"))
        return None

    def out_of_reach(self, robot: int, x: float, y: float) -> Denied | None:
        """Return a denial if no goal outside the game can lead a robot to a point of the map."""
        return None if self.plans_end_apart else self.misplaced(robot, x, y)


class Pilot:
    """The `VehicleInterface` of one robot.

    Args:
        robot: its index in the team, from 0.
        setup: facts about the game.
        start: start pose, map frame.
        speed_limit: speed limit of the robot.
        parameters: its parameters in MAVLink.
        ask: queues requests to the robots and the game for the next tick. Recordings do not contain these requests,
            because they follow from the recorded frames.
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
        self._trips = TripDispatcher(robot, ask)
        self._snapshot: TeamSnapshot | None = None
        self._game: GameState | None = None
        # Commander after all requests since the last tick.
        self._new_holder: CommandHolder | None = None

    # Command

    def take(self, station: Station) -> Denied | None:
        """See `VehicleInterface`. A station cannot command a robot that does not respond."""
        if self._game is None or self._snapshot is None:
            return _NO_GAME
        if not is_responding(self._snapshot, self._robot):
            return Denied(reasons.unresponsive_sentence(self._robot))
        self._ask(TakeCommand(self._robot, str(station)))
        self._new_holder = CommandHolder(Commander.GROUND_STATION, str(station))
        return None

    def release(self) -> None:
        """See `VehicleInterface`."""
        self._ask(ReleaseCommand(self._robot))
        self._new_holder = CommandHolder(name="" if self._game is None else self._game.robots[self._robot].seat)

    # Driving

    def go_to(self, target: Target) -> int | Denied:
        """See `VehicleInterface`. Rules and map decide at once. The navigator decides later, when the robot departs."""
        if not all(map(math.isfinite, (target.x, target.y, target.heading or 0.0))):
            return Denied("That is no point of a map.")
        state = self._able()
        if isinstance(state, Denied):
            return state
        robot, outline, here = state.robots[self._robot], self._setup.room_at(target.x, target.y), self._here()
        room = None if outline is None else Room(outline.room)
        if outline is None or room is None or (robot.bound_for is None and robot.at == room):
            cell_of = self._setup.floor.grid.cell_of
            # A robot can always stay in its own cell, even if the map shows a wall there.
            is_here = cell_of(target.x, target.y) == cell_of(here.x, here.y)
            denied = None if is_here else self._setup.out_of_reach(self._robot, target.x, target.y)
            return denied or self._trips.begin(_goal_pose(target, here), None, here, state)
        return self._trips.begin(Pose2(*outline.goal), room, here, state)

    def stop_robot(self) -> None:
        """See `VehicleInterface`."""
        self._trips.abort(reasons.STOPPED)
        self._ask(CancelGoal(self._robot))

    def drive(self, twist: Twist) -> Denied | None:
        """See `VehicleInterface`. This aborts a leg or a move of the game in progress."""
        state = self._able()
        if isinstance(state, Denied):
            return state
        self._trips.abort(reasons.BY_HAND)
        self._ask(DriveManually(self._robot, self._speed_limit.bounded(twist), MANUAL_DRIVE_TICKS))
        return None

    def fastest(self) -> Twist:
        """See `VehicleInterface`."""
        return self._speed_limit.fastest()

    def limit_speed(self, speed: float) -> Denied | None:
        """See `VehicleInterface`. A robot never drives faster than the study allows."""
        values = self._speed_limit.limit(speed)
        if isinstance(values, Denied):
            return values
        self._ask(SetParameters(self._robot, values))
        return None

    def start(self) -> Pose2:
        """See `VehicleInterface`."""
        return self._start

    def misplaced(self, x: float, y: float) -> Denied | None:
        """See `VehicleInterface`."""
        return self._setup.misplaced(self._robot, x, y)

    def unreachable(self, x: float, y: float) -> Denied | None:
        """See `VehicleInterface`."""
        return None if self._setup.room_at(x, y) is not None else self._setup.out_of_reach(self._robot, x, y)

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
        self._snapshot, self._game, self._new_holder = snapshot, game, None
        self._trips.follow(snapshot, game)
        return replace(self._readings(snapshot, game), announcements=news, participant_requests=asked)

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
            commanded_by=PARTICIPANT if robot is None else _commander_text(robot.command),
            leg=self._trips.leg,
            participant=PARTICIPANT if robot is None else robot.seat or PARTICIPANT,
        )

    # Conditions

    def _able(self) -> GameState | Denied:
        """Return the state of the game after all requests so far, or the reason why stations cannot move the robot."""
        if self._game is None or self._snapshot is None:
            return _NO_GAME
        state = self._game
        # Requests have an effect only in the next tick, but a station may arm and drive a robot in the same tick.
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

    def _here(self) -> Pose2:
        return self._start if self._snapshot is None else self._snapshot.robots[self._robot].estimate.base_in_map


def _goal_pose(target: Target, here: Pose2) -> Pose2:
    """Return the goal pose. If no heading is given, the heading is the direction from the robot to the target."""
    ahead = elementary.atan2(target.y - here.y, target.x - here.x)
    return Pose2(target.x, target.y, ahead if target.heading is None else target.heading)


def _is_at_wall(floor: TraversabilityMap, row: int, col: int) -> bool:
    """Return True for a cell in a wall, too near to a wall, or at the edge of the map. Unknown cells are not walls."""
    grid, reach = floor.grid, floor.inscribed / floor.grid.resolution
    if not (0 < row < grid.rows - 1 and 0 < col < grid.cols - 1):
        return True
    cells = math.ceil(reach)
    top, left = max(0, row - cells), max(0, col - cells)
    around = grid.cells[top : row + cells + 1, left : col + cells + 1]
    away = np.argwhere(around == OCCUPIED) - (row - top, col - left)
    return bool((np.square(away).sum(axis=1) <= reach * reach).any())


def _commander_text(command: CommandHolder) -> str:
    """Return the name of a commander without an article; for a participant with a seat, the name of the seat."""
    return command.by.value if command.by is Commander.RESEARCHER else command.name or command.by.value


_NO_GAME = Denied("The game has not begun yet.", DenialKind.NOT_NOW)
