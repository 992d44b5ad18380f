"""The state of a game, folded from its events.

`apply` does not judge: `rules` decides what may happen, and `apply` accepts what did happen. So it also takes
events that programs of 2016 cause without asking the rules:

- `RobotArrived` without a `RobotDeparted` moves the robot and pays nothing; `rules.arrive` puts the missing one before
  it.
- `RobotArrived` in another room than the destination ends the move in progress and its reservation.
- `MoveFailed` of a robot that is not moving places it and refunds nothing; no refund exceeds the price paid.
- `TreasureSensed`, `PropertyMeasured`, `PropertyTold`, `TreasurePictured`, `TreasureIdentified` and `TreasureLeft` are
  noted for rooms where no robot ever arrived, which stay unvisited.
- `TreasureIdentified` may come without room, robot or name, more than once, or after `GameEnded`: the score is the sum
  of them all.
- Energy may become negative by such events; the robot is then blocked as at 0.

States are msgspec's structs, which are replaced 25 times as fast as dataclasses.
"""

import math
from typing import TypeVar, assert_never

import msgspec
from msgspec import field
from msgspec.structs import replace

from thbridge.hunt.events import (
    Commander,
    CommanderChanged,
    Condition,
    ConditionChanged,
    ConsentGiven,
    CostsEstimated,
    Event,
    GameEnded,
    GameStarted,
    HandbackRequested,
    MoveFailed,
    PropertyMeasured,
    PropertyTold,
    RobotArrived,
    RobotDeparted,
    RoomAdvised,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
    TreasureSensed,
    TreasuresHidden,
    TreasureTakenUp,
)
from thbridge.hunt.properties import Properties
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.hunt.treasures import TreasureKind

_Part = TypeVar("_Part")


class CommandHolder(msgspec.Struct, frozen=True):
    """Commander of a robot, with a name unless it is the participant."""

    by: Commander = Commander.PARTICIPANT
    name: str = ""


class RobotState(msgspec.Struct, frozen=True):
    """One robot as the game sees it.

    Attributes:
        at: the place where it stands; during a move, the place it set out from.
        energy: energy left; the whole cost of a move is taken at its departure.
        bound_for: destination of the current move, or None.
        paid: price of the current move, the most that can be refunded.
        condition: as last reported.
        holder: its commander, who also gets it back after a researcher's intervention.
        intervention: the researcher who intervenes now, or None.
        asked_back: number of times the participant has asked its present commander to give it back.
        advice: number of its latest advice in this game; 0 before the first.
        failure: reason for which the last move that ended did not arrive, for people; empty when it arrived.
        costs: energy to each place from where it stands, by the number people use; during a move, from where it set
            out. None: those of the game's matrix.
    """

    at: Room
    energy: float
    bound_for: Room | None = None
    paid: float = 0.0
    condition: Condition = Condition.WELL
    holder: CommandHolder = CommandHolder()
    intervention: CommandHolder | None = None
    asked_back: int = 0
    advice: int = 0
    failure: str = ""
    costs: tuple[float, ...] | None = None

    @property
    def command(self) -> CommandHolder:
        """Its commander now: the researcher who intervenes, or else the holder."""
        return self.intervention or self.holder

    @property
    def is_blocked(self) -> bool:
        """True when its energy is used up: it can do nothing any more."""
        return self.energy <= 0.0

    @property
    def is_silent(self) -> bool:
        """True while it does not respond: it can do nothing until it does."""
        return self.condition is Condition.SILENT


class RoomState(msgspec.Struct, frozen=True):
    """One room as the game sees it.

    Attributes:
        visited: a robot has arrived there.
        sensed: what robots sensed of its treasure, or None.
        told: what the participant told of it.
        image: file name of the picture taken, or None.
        points: won or lost by identifying; None before.
        name: given at identification; None before, or if only the points are known.
        left: True when the treasure was given up, and not taken up again.
        finder: the robot that arrived there last, or None.
    """

    visited: bool = False
    sensed: Properties | None = None
    told: Properties = field(default_factory=dict)
    image: str | None = None
    points: int | None = None
    name: str | None = None
    left: bool = False
    finder: int | None = None

    @property
    def is_decided(self) -> bool:
        """True when its treasure was identified or given up."""
        return self.left or self.points is not None

    @property
    def known(self) -> Properties:
        """Properties of its treasure that are known, by whomever."""
        return {**(self.sensed or {}), **self.told}


class GameState(msgspec.Struct, frozen=True):
    """Everything the rules need to know.

    Attributes:
        started: the rules of this game.
        treasures: of the rooms, room 1 first; None if a Hider of 2016 hid them.
        robots: indexed by robot number.
        rooms: indexed by the room's number on the wire; read with `room`.
        score: sum of all identifications.
        ended: the end of the game, or None.
        agreed: the participant agreed to take part, where the study asks for it.
        agreed_at: time of day of that agreement; empty where it is unknown.
        by_position: moves from outside rooms are priced by where the robot stands: the matrix's row of the corridor
            holds nowhere.
    """

    started: GameStarted
    treasures: tuple[TreasureKind, ...] | None
    robots: tuple[RobotState, ...]
    rooms: tuple[RoomState, ...]
    score: int = 0
    ended: GameEnded | None = None
    agreed: bool = False
    agreed_at: str = ""
    by_position: bool = False

    def has_robot(self, robot: int) -> bool:
        """Return True when the team has a robot with this index."""
        return 0 <= robot < len(self.robots)

    def has_room(self, room: Room) -> bool:
        """Return True when this is one of the game's rooms; the corridor is not."""
        return 0 < room.people <= len(self.rooms)

    def room(self, room: Room) -> RoomState:
        """Return the state of a room. Raises ValueError for the corridor, IndexError for unknown rooms."""
        return self.rooms[room.wire]

    def treasure(self, room: Room) -> TreasureKind | None:
        """Return the treasure of a room, or None if a Hider of 2016 hid it. Raises as `room`."""
        return None if self.treasures is None else self.treasures[room.wire]

    def reserved_by(self, room: Room) -> int | None:
        """Return the robot that drives to this room, or None."""
        for number, robot in enumerate(self.robots):
            if robot.bound_for == room:
                return number
        return None

    def standing_in(self, room: Room) -> int | None:
        """Return the robot that stands in this room, or None; the lowest index if there are several."""
        for number, robot in enumerate(self.robots):
            if robot.bound_for is None and robot.at == room:
                return number
        return None

    def decider(self, room: Room) -> int | None:
        """Return the robot that may name the treasure of a room, or None.

        It is the robot that stands there, or the one that found the treasure and was sent on before the decision."""
        stander = self.standing_in(room)
        if stander is not None or not self.has_room(room):
            return stander
        known = self.room(room)
        return known.finder if known.sensed is not None and not known.is_decided else None

    def costs_from(self, robot: int) -> tuple[float, ...]:
        """Return the energy of a robot's moves from where it stands, by the number people use; infinite without one."""
        mover = self.robots[robot]
        return self.started.costs.rows[mover.at.people] if mover.costs is None else mover.costs

    def cost(self, robot: int, room: Room) -> float:
        """Return the energy of a robot's move to a room; infinite when there is no way."""
        return self.costs_from(robot)[room.people]

    @property
    def free_rooms(self) -> tuple[Room, ...]:
        """Rooms that are neither visited nor reserved, in counting order: where a robot may be sent."""
        reserved = [robot.bound_for.people for robot in self.robots if robot.bound_for is not None]
        rooms = zip(self.started.costs.rooms, self.rooms, strict=True)
        return tuple([room for room, state in rooms if not state.visited and room.people not in reserved])


def begin(started: GameStarted) -> GameState:
    """Return the state right after the start of a game."""
    return GameState(
        started=started,
        treasures=None,
        robots=(RobotState(CORRIDOR, started.energy),) * started.robots,
        rooms=(RoomState(),) * len(started.costs.rooms),
    )


def apply(state: GameState, event: Event) -> GameState:
    """Return the state after an event; `GameStarted` begins a new game.

    Raises:
        ValueError: the event belongs to another game: it names a robot or room that this game does not have, or its
            number of treasures is not the number of rooms.
    """
    match event:
        case GameStarted():
            return begin(event)
        case TreasuresHidden():
            if len(event.treasures) != len(state.rooms):
                raise ValueError(f"{len(event.treasures)} treasures are hidden in {len(state.rooms)} rooms")
            return replace(state, treasures=event.treasures)
        case ConsentGiven(at):
            return replace(state, agreed=True, agreed_at=at)
        case RoomAdvised():
            _room(state, event.room)
            return _with_robot(state, event.robot, replace(_robot(state, event.robot), advice=event.advice))
        case RobotDeparted():
            robot = _robot(state, event.robot)
            _room(state, event.room)
            return _with_robot(
                state,
                event.robot,
                replace(robot, energy=robot.energy - event.cost, bound_for=event.room, paid=event.cost),
            )
        case RobotArrived():
            room = replace(_room(state, event.room), visited=True, finder=event.robot)
            robots = _with(state.robots, event.robot, _standing(_robot(state, event.robot), event.room))
            return replace(state, robots=robots, rooms=_with(state.rooms, event.room.wire, room))
        case MoveFailed():
            robot = _robot(state, event.robot)
            refund = min(event.refund, robot.paid)
            stopped = _standing(robot, event.at, event.reason)
            return _with_robot(state, event.robot, replace(stopped, energy=robot.energy + refund))
        case ConditionChanged():
            robot = _robot(state, event.robot)
            return _with_robot(state, event.robot, replace(robot, condition=event.condition))
        case CostsEstimated():
            if len(event.costs) != len(state.rooms) + 1:
                raise ValueError(f"{len(event.costs)} costs are given for {len(state.rooms) + 1} places")
            costs = tuple(math.inf if cost is None else cost for cost in event.costs)
            priced = replace(state, by_position=True)
            return _with_robot(priced, event.robot, replace(_robot(state, event.robot), costs=costs))
        case CommanderChanged():
            robot = _robot(state, event.robot)
            command = CommandHolder(event.by, event.name)
            return _with_robot(
                state,
                event.robot,
                replace(robot, intervention=command, asked_back=0)
                if event.by is Commander.RESEARCHER
                else replace(robot, holder=command, intervention=None, asked_back=0),
            )
        case HandbackRequested():
            robot = _robot(state, event.robot)
            return _with_robot(state, event.robot, replace(robot, asked_back=robot.asked_back + 1))
        case TreasureSensed():
            return _with_room(state, event.room, replace(_room(state, event.room), sensed=event.properties))
        case PropertyMeasured():
            room = _room(state, event.room)
            sensed = {**(room.sensed or {}), event.property: event.value}
            state = _with_room(state, event.room, replace(room, sensed=sensed))
            return _charge(state, event.robot, event.cost)
        case PropertyTold():
            room = _room(state, event.room)
            return _with_room(state, event.room, replace(room, told={**room.told, event.property: event.value}))
        case TreasurePictured():
            state = _with_room(state, event.room, replace(_room(state, event.room), image=event.image))
            return _charge(state, event.robot, event.cost)
        case TreasureIdentified():
            if event.room is not None:
                state = _with_room(
                    state, event.room, replace(_room(state, event.room), points=event.points, name=event.name)
                )
            if event.robot is not None:
                state = _charge(state, event.robot, event.cost)
            return replace(state, score=state.score + event.points)
        case TreasureLeft():
            return _with_room(state, event.room, replace(_room(state, event.room), left=True))
        case TreasureTakenUp():
            return _with_room(state, event.room, replace(_room(state, event.room), left=False))
        case GameEnded():
            return replace(state, ended=event)
        case _:
            assert_never(event)


def _standing(robot: RobotState, at: Room, failure: str = "") -> RobotState:
    return replace(robot, at=at, bound_for=None, paid=0.0, failure=failure, costs=None)


def _robot(state: GameState, number: int) -> RobotState:
    if not state.has_robot(number):
        raise ValueError(f"there is no robot {number} in a team of {len(state.robots)}")
    return state.robots[number]


def _room(state: GameState, room: Room) -> RoomState:
    if not state.has_room(room):
        raise ValueError(f"{room} is not one of the {len(state.rooms)} rooms of this game")
    return state.rooms[room.wire]


def _with_robot(state: GameState, number: int, robot: RobotState) -> GameState:
    return replace(state, robots=_with(state.robots, number, robot))


def _with_room(state: GameState, room: Room, changed: RoomState) -> GameState:
    return replace(state, rooms=_with(state.rooms, room.wire, changed))


def _with(those: tuple[_Part, ...], index: int, changed: _Part) -> tuple[_Part, ...]:
    return (*those[:index], changed, *those[index + 1 :])


def _charge(state: GameState, number: int, cost: float) -> GameState:
    robot = _robot(state, number)
    return _with_robot(state, number, replace(robot, energy=robot.energy - cost))
