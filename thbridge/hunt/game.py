"""Computation of the state of a game from its events.

`apply` does not check events. `rules` decides which events may happen, and `apply` accepts all events that happened. So
it also accepts events that programs of 2016 cause without the rules:

- `RobotArrived` without a `RobotDeparted` moves the robot without a cost; `rules.arrive` adds the missing departure.
- `RobotArrived` in a room that is not the destination ends the move in progress and its reservation.
- `MoveFailed` of a robot that is not moving changes its place without a refund; a refund never exceeds the paid price.
- `TreasureSensed`, `PropertyMeasured`, `PropertyTold`, `TreasurePictured`, `TreasureIdentified` and `TreasureLeft` may
  be about rooms without an arrival of a robot; these rooms stay unvisited.
- `TreasureIdentified` may have no room, robot or name, may be repeated, and may follow `GameEnded`; the score is the
  sum of all points.
  - These events may make energy negative; then the robot is blocked, as with an energy of 0.

States are structs of msgspec, because `replace` is 25 times as fast for structs as for dataclasses.
"""

import math
from collections.abc import Mapping
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
from thbridge.hunt.seats import Seat, commanding_seat, label_of, seat_named
from thbridge.hunt.treasures import TreasureKind

_Part = TypeVar("_Part")


class CommandHolder(msgspec.Struct, frozen=True):
    """Commander of a robot, and the commander's name.

    The name of a participant is the name of their seat; in a game with one participant, it is empty.
    """

    by: Commander = Commander.PARTICIPANT
    name: str = ""


class RobotState(msgspec.Struct, frozen=True):
    """One robot in the game.

    Attributes:
        at: present place of the robot; during a move, the start of the move.
        energy: remaining energy. The complete cost of a move is subtracted at the departure.
        bound_for: destination of the current move, or None.
        paid: price of the current move, which is the largest possible refund.
        condition: the last reported condition.
        holder: commander of the robot, also after the end of a researcher's intervention.
        intervention: the researcher who intervenes at present, or None.
        seat: seat of the participant who commands the robot when no other party commands it.
        asked_back: number of times that a participant asked the present commander to give the robot back.
        asked_by: seat of the participant who asked last. Empty if no participant has asked, and in a game with one
            participant.
        advice: number of the robot's latest advice in this game; 0 before the first advice.
        failure: reason for people why the last move did not reach its room; empty if it did.
        costs: energy to each place from the robot's present position, by the number for people; during a move, from the
            start of the move. If None, the game's matrix has the costs.
    """

    at: Room
    energy: float
    bound_for: Room | None = None
    paid: float = 0.0
    condition: Condition = Condition.WELL
    holder: CommandHolder = CommandHolder()
    intervention: CommandHolder | None = None
    seat: str = ""
    asked_back: int = 0
    asked_by: str = ""
    advice: int = 0
    failure: str = ""
    costs: tuple[float, ...] | None = None

    @property
    def command(self) -> CommandHolder:
        """Present commander of the robot: the intervening researcher, or otherwise the holder."""
        return self.intervention or self.holder

    @property
    def is_blocked(self) -> bool:
        """True if its energy is used up, so that it can do nothing."""
        return self.energy <= 0.0

    @property
    def is_silent(self) -> bool:
        """True while it does not respond; it can do nothing during this time."""
        return self.condition is Condition.SILENT


class RoomState(msgspec.Struct, frozen=True):
    """A room in the game.

    Attributes:
        visited: True if a robot has arrived there.
        sensed: properties of the treasure that robots sensed, or None.
        `told`: properties of the treasure that the participant reported.
        image: file name of the picture, or None if no picture was taken.
        points: points for the participant's name of the treasure, or None before it is named.
        name: the participant's name of the treasure. None before it is named, and if only the points are known.
        left: True if the participant has left the treasure undecided.
        finder: index of the robot that arrived in the room last, or None.
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
        """True if the treasure was named or left."""
        return self.left or self.points is not None

    @property
    def known(self) -> Properties:
        """Known properties of the treasure, from all sources."""
        return {**(self.sensed or {}), **self.told}


class GameState(msgspec.Struct, frozen=True):
    """The complete state that the rules need.

    Attributes:
        started: the rules and numbers of this game.
        treasures: treasures of the rooms, in the order of the rooms. None if a Hider of 2016 hid them.
        robots: robots, by index.
        rooms: rooms, by their number in the text protocol. To read a room, use the method `room`.
        score: total points of all named treasures.
        ended: the end of the game, or None.
        agreed: True if all participants agreed to take part. Only studies with consent use this value.
        agreed_at: date and time of the last agreement; empty if unknown.
        agreements: seats whose participants agreed, with date and time.
        by_position: True if the price of a move from outside the rooms depends on the robot's position. Then the
            matrix's row for the corridor is not used.
    """

    started: GameStarted
    treasures: tuple[TreasureKind, ...] | None
    robots: tuple[RobotState, ...]
    rooms: tuple[RoomState, ...]
    score: int = 0
    ended: GameEnded | None = None
    agreed: bool = False
    agreed_at: str = ""
    agreements: Mapping[str, str] = field(default_factory=dict)
    by_position: bool = False

    def seat(self, name: str) -> Seat | None:
        """Return the seat with this name, or None; see `seat_named`."""
        return seat_named(self.started.seats, name)

    def label_of(self, name: str) -> str:
        """Return the words for the participant of the seat with this name in a sentence."""
        return label_of(self.started.seats, name)

    def has_robot(self, robot: int) -> bool:
        """Return True if the team has a robot with this index."""
        return 0 <= robot < len(self.robots)

    def has_room(self, room: Room) -> bool:
        """Return True if this is one of the game's rooms. The corridor is no room."""
        return 0 < room.people <= len(self.rooms)

    def room(self, room: Room) -> RoomState:
        """Return the state of a room. Raises ValueError for the corridor, IndexError for unknown rooms."""
        return self.rooms[room.wire]

    def treasure(self, room: Room) -> TreasureKind | None:
        """Return the treasure of a room, or None if a Hider of 2016 hid it. Raises the same errors as `room`."""
        return None if self.treasures is None else self.treasures[room.wire]

    def reserved_by(self, room: Room) -> int | None:
        """Return the index of the robot that drives to this room, or None."""
        for number, robot in enumerate(self.robots):
            if robot.bound_for == room:
                return number
        return None

    def standing_in(self, room: Room) -> int | None:
        """Return the index of the robot in this room, or None. If there are several robots, return the lowest index."""
        for number, robot in enumerate(self.robots):
            if robot.bound_for is None and robot.at == room:
                return number
        return None

    def decider(self, room: Room) -> int | None:
        """Return the index of the robot that may name the treasure in a room, or None.

        This is the robot in the room. If there is none, it is the robot that found the treasure and was sent to another
        room before the decision.
        """
        stander = self.standing_in(room)
        if stander is not None or not self.has_room(room):
            return stander
        known = self.room(room)
        return known.finder if known.sensed is not None and not known.is_decided else None

    def costs_from(self, robot: int) -> tuple[float, ...]:
        """Return the energy of a robot's moves from its present position. The index is the goal's number for people.

        A cost is infinite if there is no move.
        """
        mover = self.robots[robot]
        return self.started.costs.rows[mover.at.people] if mover.costs is None else mover.costs

    def cost(self, robot: int, room: Room) -> float:
        """Return the energy of a robot's move to a room, infinite if there is no path."""
        return self.costs_from(robot)[room.people]

    @property
    def free_rooms(self) -> tuple[Room, ...]:
        """Rooms that are neither visited nor reserved, ordered by number. Robots may be sent to these rooms."""
        reserved = [robot.bound_for.people for robot in self.robots if robot.bound_for is not None]
        rooms = zip(self.started.costs.rooms, self.rooms, strict=True)
        return tuple([room for room, state in rooms if not state.visited and room.people not in reserved])


def begin(started: GameStarted) -> GameState:
    """Return the state directly after the start of a game."""
    seats = (commanding_seat(started.seats, robot) for robot in range(started.robots))
    return GameState(
        started=started,
        treasures=None,
        robots=tuple(
            RobotState(CORRIDOR, started.energy, holder=CommandHolder(name=seat), seat=seat) for seat in seats
        ),
        rooms=(RoomState(),) * len(started.costs.rooms),
    )


def apply(state: GameState, event: Event) -> GameState:
    """Return the state after an event. `GameStarted` begins a new game.

    Raises:
        ValueError: the event is for another game: this game does not have its robot or room, or has another number of
            rooms.
    """
    match event:
        case GameStarted():
            return begin(event)
        case TreasuresHidden():
            if len(event.treasures) != len(state.rooms):
                raise ValueError(f"{len(event.treasures)} treasures are hidden in {len(state.rooms)} rooms")
            return replace(state, treasures=event.treasures)
        case ConsentGiven(at, seat):
            agreements = {**state.agreements, seat: at}
            agreed = all(each.name in agreements for each in state.started.seats)
            return replace(state, agreed=agreed, agreed_at=at, agreements=agreements)
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
            robot = replace(robot, asked_back=0, asked_by="")
            if event.by is Commander.RESEARCHER:
                return _with_robot(state, event.robot, replace(robot, intervention=command))
            seat = event.name if event.by is Commander.PARTICIPANT else robot.seat
            return _with_robot(state, event.robot, replace(robot, holder=command, intervention=None, seat=seat))
        case HandbackRequested():
            robot = _robot(state, event.robot)
            return _with_robot(state, event.robot, replace(robot, asked_back=robot.asked_back + 1, asked_by=event.seat))
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
