"""Rules of the game. Each rule receives the state and a request, and returns the resulting events or a refusal.

Rules do not change the state. The caller applies the events (`game.apply`), writes them into the journal, and then
calls `ending`.
"""

import math
from collections.abc import Callable, Collection, Sequence
from enum import StrEnum

from sim.common.robot_numbers import robot_name
from thbridge.hunt.costs import energy_text
from thbridge.hunt.events import (
    Commander,
    CommanderChanged,
    Condition,
    ConditionChanged,
    CostsEstimated,
    EndReason,
    Event,
    GameEnded,
    HandbackRequested,
    MoveFailed,
    PropertyMeasured,
    PropertyTold,
    RobotArrived,
    RobotDeparted,
    TreasureIdentified,
    TreasureLeft,
    TreasurePictured,
    TreasureSensed,
    TreasureTakenUp,
)
from thbridge.hunt.game import CommandHolder, GameState, apply
from thbridge.hunt.properties import Properties, Teller, property_named
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import CORRIDOR, Room
from thbridge.hunt.seats import capitalized
from thbridge.hunt.treasures import same_name

MOST_ROBOTS = 250
"""Largest size of a team. In MAVLink, system ids up to 250 are for vehicles, and higher ids are for ground stations."""


class RuleReason(StrEnum):
    """Reason why a rule refuses a request."""

    GAME_OVER = "game-over"
    UNKNOWN_ROBOT = "unknown-robot"
    UNKNOWN_ROOM = "unknown-room"
    UNDER_WAY = "under-way"
    NOT_UNDER_WAY = "not-under-way"
    SILENT = "silent"
    BLOCKED = "blocked"
    COMMANDED = "commanded"
    ALREADY_VISITED = "already-visited"
    RESERVED = "reserved"
    NOT_A_MOVE = "not-a-move"
    NOT_ENOUGH_ENERGY = "not-enough-energy"
    NOBODY_THERE = "nobody-there"
    NOTHING_KNOWN = "nothing-known"
    ALREADY_DECIDED = "already-decided"
    UNKNOWN_PROPERTY = "unknown-property"
    UNKNOWN_SEAT = "unknown-seat"
    NOT_ALLOWED = "not-allowed"


Ruling = tuple[Event, ...] | RequestRefused


def command(state: GameState, robot: int, by: CommandHolder) -> Ruling:
    """Make the participant or a ground station the commander of a robot. A researcher's intervention continues.

    This is also possible after the end of a game: robots can drive, and the result of the game does not change. A
    moving robot continues its move. A repeated request gives no event.
    """
    if not state.has_robot(robot):
        return _no_robot(state, robot)
    now = state.robots[robot]
    if now.holder == by:
        return ()
    given = CommanderChanged(robot, by.by, by.name)
    return (given,) if now.intervention is None else (given, _intervenes(robot, now.intervention.name))


def intervene(state: GameState, robot: int, researcher: str | None) -> Ruling:
    """Start the intervention of the researcher with this name. If None, end it; the holder commands the robot again.

    A repeated request gives no event.
    """
    if not state.has_robot(robot):
        return _no_robot(state, robot)
    now = state.robots[robot]
    if researcher is None:
        return () if now.intervention is None else (CommanderChanged(robot, now.holder.by, now.holder.name),)
    same = now.intervention is not None and now.intervention.name == researcher
    return () if same else (_intervenes(robot, researcher),)


def request_handback(state: GameState, robot: int, seat: str = "") -> Ruling:
    """Ask another commander to give a robot to a seat. If this seat commands the robot, there is no event."""
    refused = _over(state)
    if refused:
        return refused
    if not state.has_robot(robot):
        return _no_robot(state, robot)
    return () if state.robots[robot].command == CommandHolder(name=seat) else (HandbackRequested(robot),)


def hand_over(state: GameState, robot: int, seat: str) -> Ruling:
    """Make another seat the commander of a robot that a participant commands. A repeated request gives no event."""
    refused = _over(state)
    if refused:
        return refused
    if not state.has_robot(robot):
        return _no_robot(state, robot)
    to = state.seat(seat)
    if to is None:
        return RequestRefused(RuleReason.UNKNOWN_SEAT, "There is no such seat in this game.")
    if not to.can_take_over:
        return RequestRefused(RuleReason.NOT_ALLOWED, f"{capitalized(to.label)} cannot take over robots.")
    return commanded_by_other(state, robot, Commander.PARTICIPANT) or command(state, robot, CommandHolder(name=seat))


def commanded_by_other(state: GameState, robot: int, asker: Commander) -> RequestRefused | None:
    """Return a refusal if a party other than the asker commands the robot, otherwise None."""
    now = state.robots[robot].command
    if now.by is asker:
        return None
    who = state.label_of(now.name) if now.by is Commander.PARTICIPANT else commander_name(now.by, now.name)
    return RequestRefused(RuleReason.COMMANDED, f"{_name(robot)} is commanded by {who} just now.")


def commanded_by_other_seat(state: GameState, robot: int, seat: str) -> RequestRefused | None:
    """Return a refusal if a party other than the participant of a seat commands the robot, otherwise None."""
    if not state.has_robot(robot):
        return _no_robot(state, robot)
    now = state.robots[robot].command
    other = None if now.by is not Commander.PARTICIPANT or now.name == seat else state.seat(now.name)
    if other is None:
        return commanded_by_other(state, robot, Commander.PARTICIPANT)
    return RequestRefused(RuleReason.COMMANDED, f"{_name(robot)} is commanded by {other.label} just now.")


def unable(state: GameState, robot: int) -> RequestRefused | None:
    """Return the reason why a robot cannot obey any commander at present, or None."""
    worker = state.robots[robot]
    if state.ended is not None:
        return _over(state)
    if worker.is_silent:
        return _silent(robot)
    return _blocked(robot) if worker.is_blocked else None


def commander_name(by: Commander, name: str) -> str:
    """Return the words for a commander in a sentence. Names of researchers' programs are omitted."""
    match by:
        case Commander.PARTICIPANT:
            return "the participant"
        case Commander.GROUND_STATION:
            return name or "a ground station"
        case Commander.TEAMMATE:
            return name
        case Commander.RESEARCHER:
            return "a researcher"


def move(state: GameState, robot: int, room: Room, asker: Commander = Commander.PARTICIPANT) -> Ruling:
    """Send a robot to a room. If the participant sends it, an undecided treasure in its present room counts as left.

    If another commander sends the robot, the participant can name this treasure later (`GameState.decider`).
    """
    refused = _over(state) or _unknown(state, robot, room) or commanded_by_other(state, robot, asker)
    if refused:
        return refused
    mover = state.robots[robot]
    if mover.bound_for is not None:
        return RequestRefused(RuleReason.UNDER_WAY, f"{_name(robot)} is still under way to {mover.bound_for}.")
    refused = unable(state, robot)
    if refused:
        return refused
    if state.room(room).visited:
        return RequestRefused(RuleReason.ALREADY_VISITED, f"{_capital(room)} has been visited already.")
    other = state.reserved_by(room)
    if other is not None:
        return RequestRefused(RuleReason.RESERVED, f"{_name(other)} is already under way to {room}.")
    cost = state.cost(robot, room)
    if math.isinf(cost):
        return RequestRefused(RuleReason.NOT_A_MOVE, f"There is no path from {mover.at} to {room}.")
    if cost > mover.energy:
        return _too_dear(robot, f"going to {room}", cost, mover.energy)
    left: tuple[Event, ...] = ()
    if asker is Commander.PARTICIPANT and not mover.at.is_corridor:
        here = state.room(mover.at)
        left = (TreasureLeft(mover.at),) if here.sensed is not None and not here.is_decided else ()
    return (*left, RobotDeparted(robot, room, cost))


def arrive(state: GameState, robot: int, room: Room) -> Ruling:
    """Record the arrival of a robot in a room.

    If there was no departure (a program of 2016 sent the robot), a departure is added. The price of this move is from
    the matrix, even if the robot has less energy. If the robot had another destination, that move fails without a
    refund.
    """
    refused = _over(state) or _unknown(state, robot, room)
    if refused:
        return refused
    mover = state.robots[robot]
    if mover.bound_for == room:
        return (RobotArrived(robot, room),)
    if mover.bound_for is not None:
        return (MoveFailed(robot, mover.bound_for, f"arrived in {room} instead", 0.0, room), RobotArrived(robot, room))
    cost = state.cost(robot, room)
    return (RobotDeparted(robot, room, 0.0 if math.isinf(cost) else cost), RobotArrived(robot, room))


def fail(state: GameState, robot: int, reason: str, share_done: float, at: Room | None = None) -> Ruling:
    """End a robot's move without an arrival, because the navigator failed or a person stopped the robot.

    Args:
        state: the game.
        robot: index of the robot, from 0.
        reason: reason for people, such as "cancelled" or the navigator's sentence.
        share_done: driven share of the path, clipped to [0, 1]. The other share of the price is refunded.
        at: present room of the robot. If None, it is the start of the move for a robot that has not moved, and
            otherwise the corridor. A robot in an unvisited room also counts as a robot in the corridor. Otherwise it
            could not be sent to this room again.
    """
    if not state.has_robot(robot):
        return _no_robot(state, robot)
    mover = state.robots[robot]
    if mover.bound_for is None:
        return RequestRefused(RuleReason.NOT_UNDER_WAY, f"{_name(robot)} is not under way.")
    done = min(max(share_done, 0.0), 1.0)
    if at is None:
        at = mover.at if done == 0.0 else CORRIDOR
    elif not (state.has_room(at) and state.room(at).visited):
        at = CORRIDOR
    return (MoveFailed(robot, mover.bound_for, reason, mover.paid * (1.0 - done), at),)


def report(state: GameState, robot: int, condition: Condition) -> Ruling:
    """Record a robot's condition. An unchanged condition gives no event."""
    refused = _over(state)
    if refused:
        return refused
    if not state.has_robot(robot):
        return _no_robot(state, robot)
    return () if state.robots[robot].condition is condition else (ConditionChanged(robot, condition),)


def price(state: GameState, robot: int, costs: Sequence[float | None]) -> Ruling:
    """Record the costs of a standing robot's moves from its present position. Unchanged costs give no event."""
    refused = _over(state)
    if refused:
        return refused
    if not state.has_robot(robot):
        return _no_robot(state, robot)
    mover = state.robots[robot]
    if mover.bound_for is not None:
        return RequestRefused(RuleReason.UNDER_WAY, f"{_name(robot)} is under way, and its move is already paid.")
    if len(costs) != len(state.rooms) + 1 or any(cost is not None and not cost >= 0.0 for cost in costs):
        return RequestRefused(RuleReason.UNKNOWN_ROOM, f"{len(state.rooms) + 1} costs of 0 or more are needed.")
    # A robot in a room has no move to the same room, even if it is at some distance from the goal pose.
    row = tuple(None if place == mover.at.people else cost for place, cost in enumerate(costs))
    estimated = CostsEstimated(robot, row)
    return () if apply(state, estimated).costs_from(robot) == state.costs_from(robot) else (estimated,)


def sense(state: GameState, room: Room, reported: Properties | None = None) -> Ruling:
    """Record the properties that a robot senses when it finds a treasure. A repeated request gives no event.

    Args:
        state: the game.
        room: the room.
        reported: properties from a Hider of 2016. If None, use the properties in the state.
    """
    found = _standing_robot(state, room)
    if isinstance(found, RequestRefused):
        return found
    if state.room(room).sensed is not None:
        return ()
    treasure = state.treasure(room)
    if reported is not None:
        return (TreasureSensed(room, reported),)
    if treasure is None:
        return _nothing_known(room)
    names = (each.name for each in state.started.properties if each.is_found and each.name in treasure.properties)
    return (TreasureSensed(room, {name: treasure.properties[name] for name in names}),)


def measure(state: GameState, room: Room, name: str) -> Ruling:
    """Sense a further property of a found treasure. This costs energy. A repeated request gives no event."""
    robot = _standing_robot(state, room)
    if isinstance(robot, RequestRefused):
        return robot
    measured = property_named(state.started.properties, name)
    treasure, sensed = state.treasure(room), state.room(room).sensed
    if measured is None or not measured.is_measured:
        return RequestRefused(RuleReason.UNKNOWN_PROPERTY, f"No robot can be asked to sense {name or 'that'}.")
    if treasure is None or sensed is None or name not in treasure.properties:
        return _nothing_known(room)
    if name in sensed:
        return ()
    if state.room(room).is_decided:
        return _decided(room)
    return _paid(state, robot, f"sensing the {measured.label.lower()}", measured.cost) or (
        PropertyMeasured(room, robot, name, treasure.properties[name], measured.cost),
    )


def tell(state: GameState, room: Room, name: str, value: str) -> Ruling:
    """Record a property that the participant reports from the picture. It costs no energy.

    This is possible until the participant has decided on the treasure. A new value replaces the previous value. A
    repeated value gives no event.
    """
    refused = _over(state) or _no_room(state, room)
    if refused:
        return refused
    known, told = state.room(room), property_named(state.started.properties, name)
    if told is None or told.told_by is not Teller.PERSON or value not in told.values:
        return RequestRefused(
            RuleReason.UNKNOWN_PROPERTY, f"{value or 'That'} is not a value that people can enter here."
        )
    if known.is_decided:
        return _decided(room)
    if known.image is None:
        return RequestRefused(RuleReason.NOTHING_KNOWN, f"There is no picture of what is in {room} yet.")
    return () if known.told.get(name) == value else (PropertyTold(room, name, value),)


def picture(state: GameState, room: Room, reported: str | None = None) -> Ruling:
    """Take a picture in the room of a robot.

    The first request in a room costs energy. Later requests show the same picture without cost.

    Args:
        state: the game.
        room: the room.
        reported: file name from a Hider of 2016. If None, use the name in the state.
    """
    robot = _standing_robot(state, room)
    if isinstance(robot, RequestRefused):
        return robot
    taken = state.room(room).image
    if taken is not None:
        return (TreasurePictured(room, robot, taken, 0.0),)
    treasure = state.treasure(room)
    image = reported if reported is not None or treasure is None else treasure.image
    if image is None:
        return _nothing_known(room)
    return _paid(state, robot, "a picture", state.started.picture_cost) or (
        TreasurePictured(room, robot, image, state.started.picture_cost),
    )


def identify(state: GameState, room: Room, name: str, reported: int | None = None) -> Ruling:
    """Name the treasure in a room. A right name wins the points. A wrong name costs a share of the points
    (`wrong_share`). A second name is refused.

    The paying robot is in the room, or has found the treasure and was sent to another room by a ground station.

    Lost points are rounded to the nearest whole number (half away from zero), because the text protocol has only whole
    points. Difference from 2016: the Hider of 2016 also accepted a longer name that contains the right name.

    Args:
        state: the game.
        room: the room.
        name: name of a treasure. Case and spaces do not matter.
        reported: points from a Hider of 2016. If None, compare the name with the treasure in the state.
    """
    robot = _present(state, room, state.decider)
    if isinstance(robot, RequestRefused):
        return robot
    if state.room(room).is_decided:
        return _decided(room)
    points = reported
    treasure = state.treasure(room)
    if points is None:
        if treasure is None:
            return _nothing_known(room)
        lost = math.floor(treasure.points * state.started.wrong_share + 0.5)
        points = treasure.points if same_name(name, treasure.name) else -lost
    return _paid(state, robot, "identifying", state.started.identify_cost) or (
        TreasureIdentified(room, robot, name, points, state.started.identify_cost),
    )


def leave(state: GameState, room: Room) -> Ruling:
    """Leave the treasure in a room undecided. A treasure that was already left gives no event."""
    refused = _over(state) or _no_room(state, room)
    if refused:
        return refused
    if not state.room(room).visited:
        return RequestRefused(RuleReason.NOBODY_THERE, f"No robot has been in {room} yet.")
    if state.room(room).left:
        return ()
    return _decided(room) if state.room(room).is_decided else (TreasureLeft(room),)


def take_up(state: GameState, room: Room) -> Ruling:
    """Return to a treasure that was left in a room. A robot must be in the room.

    A treasure that was not left gives no event.
    """
    refused = _over(state) or _no_room(state, room)
    if refused:
        return refused
    known = state.room(room)
    if known.points is not None:
        return _decided(room)
    if not known.left:
        return ()
    if state.standing_in(room) is None:
        return RequestRefused(RuleReason.NOBODY_THERE, f"No robot stands in {room} any more.")
    return (TreasureTakenUp(room),)


def end_game(state: GameState) -> Ruling:
    """End the game early. Moving robots must arrive or be stopped first."""
    refused = _over(state)
    if refused:
        return refused
    for number, robot in enumerate(state.robots):
        if robot.bound_for is not None:
            return RequestRefused(RuleReason.UNDER_WAY, f"{_name(number)} is still under way to {robot.bound_for}.")
    return (GameEnded(EndReason.GIVEN_UP, state.score),)


def ending(
    state: GameState, *, wait_for_decisions: bool = True, empty: Collection[str] = frozenset()
) -> tuple[Event, ...]:
    """Return a `GameEnded` event if the game is over, otherwise no event.

    The game is over if no robot is moving, and all rooms are visited or no robot has energy for another move. The game
    does not wait for silent robots and empty seats.

    Args:
        state: the game.
        wait_for_decisions: True to wait for the decision on each treasure that a robot can name. False for participants
            of 2016, who never leave a treasure. If a ground station commands the robot at this treasure, the game waits
            in both cases, because the station will give the robot back.
        empty: seats without participants. The game does not wait for moves of their robots. If no other seat names
            treasures, it does not wait for decisions on treasures.
    """
    if empty and all(seat.name in empty for seat in state.started.seats if seat.names_treasures):
        wait_for_decisions = False
    if state.ended is not None or any(robot.bound_for is not None for robot in state.robots):
        return ()
    undecided = [room for room in state.started.costs.rooms if _may_be_decided(state, room)]
    if any(wait_for_decisions or _waits_for_station(state, room) for room in undecided):
        return ()
    if all(room.visited for room in state.rooms):
        return (GameEnded(EndReason.ALL_VISITED, state.score),)
    if any(affordable(state, robot) for robot in range(len(state.robots)) if not _has_left(state, robot, empty)):
        return ()
    return (GameEnded(EndReason.NO_MOVE_LEFT, state.score),)


def affordable(state: GameState, robot: int) -> tuple[Room, ...]:
    """Return the free rooms that this robot has energy for. For a blocked or silent robot, return no rooms."""
    mover = state.robots[robot]
    if mover.is_blocked or mover.is_silent:
        return ()
    costs = state.costs_from(robot)
    return tuple([room for room in state.free_rooms if costs[room.people] <= mover.energy])


def _has_left(state: GameState, robot: int, empty: Collection[str]) -> bool:
    """Return True if a robot's commander is an empty seat."""
    command = state.robots[robot].command
    return command.by is Commander.PARTICIPANT and command.name in empty


def _intervenes(robot: int, researcher: str) -> CommanderChanged:
    return CommanderChanged(robot, Commander.RESEARCHER, researcher)


def _may_be_decided(state: GameState, room: Room) -> bool:
    if state.room(room).is_decided:
        return False
    robot = state.decider(room)
    if robot is None:
        return False
    worker = state.robots[robot]
    return not (worker.is_silent or worker.is_blocked or worker.energy < state.started.identify_cost)


def _waits_for_station(state: GameState, room: Room) -> bool:
    stander = state.standing_in(room)
    held = stander is not None and state.robots[stander].holder.by is Commander.GROUND_STATION
    return held and state.treasures is not None


def _standing_robot(state: GameState, room: Room) -> int | RequestRefused:
    return _present(state, room, state.standing_in)


def _present(state: GameState, room: Room, who: Callable[[Room], int | None]) -> int | RequestRefused:
    """Return the index of the robot for an action in a room, or a refusal if no robot responds there."""
    refused = _over(state) or _no_room(state, room)
    if refused:
        return refused
    robot = who(room)
    if robot is None:
        return RequestRefused(RuleReason.NOBODY_THERE, f"No robot stands in {room}.")
    return _silent(robot) if state.robots[robot].is_silent else robot


def _paid(state: GameState, robot: int, what: str, cost: float) -> RequestRefused | None:
    worker = state.robots[robot]
    if worker.is_blocked:
        return _blocked(robot)
    if cost > worker.energy:
        return _too_dear(robot, what, cost, worker.energy)
    return None


def _over(state: GameState) -> RequestRefused | None:
    return None if state.ended is None else RequestRefused(RuleReason.GAME_OVER, "The game is over.")


def _unknown(state: GameState, robot: int, room: Room) -> RequestRefused | None:
    return _no_room(state, room) if state.has_robot(robot) else _no_robot(state, robot)


def _no_robot(state: GameState, robot: int) -> RequestRefused:
    return RequestRefused(
        RuleReason.UNKNOWN_ROBOT, f"There is no {robot_name(robot)}; the team has {len(state.robots)}."
    )


def _no_room(state: GameState, room: Room) -> RequestRefused | None:
    if state.has_room(room):
        return None
    return RequestRefused(
        RuleReason.UNKNOWN_ROOM, f"{_capital(room)} is not a room of this game; it has 1 to {len(state.rooms)}."
    )


def _silent(robot: int) -> RequestRefused:
    return RequestRefused(RuleReason.SILENT, f"{_name(robot)} no longer answers.")


def _blocked(robot: int) -> RequestRefused:
    return RequestRefused(RuleReason.BLOCKED, f"{_name(robot)} has no energy left.")


def _too_dear(robot: int, what: str, cost: float, energy: float) -> RequestRefused:
    return RequestRefused(
        RuleReason.NOT_ENOUGH_ENERGY,
        f"{_name(robot)} has {energy_text(energy)} energy left, but {what} costs {energy_text(cost)}.",
    )


def _nothing_known(room: Room) -> RequestRefused:
    return RequestRefused(RuleReason.NOTHING_KNOWN, f"Nothing is known about a treasure in {room}.")


def _decided(room: Room) -> RequestRefused:
    return RequestRefused(RuleReason.ALREADY_DECIDED, f"The treasure in {room} has been decided already.")


def _name(robot: int) -> str:
    return robot_name(robot).capitalize()


def _capital(room: Room) -> str:
    return capitalized(str(room))
