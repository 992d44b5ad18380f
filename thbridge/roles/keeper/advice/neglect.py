"""Decisions of robots that the participant has ignored for a time."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from thbridge.hunt import rules
from thbridge.hunt.events import Commander, Event, TreasureLeft
from thbridge.hunt.game import GameState
from thbridge.hunt.rooms import Room


@dataclass(frozen=True, slots=True)
class AloneDecision:
    """Decision of a robot without the participant.

    Attributes:
        robot: index of the robot.
        room: the robot's next room, or its present room.
        events: events that carry out the decision.
        departs: True if the robot drives to the room.
    """

    robot: int
    room: Room
    events: tuple[Event, ...]
    departs: bool


def neglected(state: GameState, attended: Mapping[int, int], tick: int, timeout: int) -> tuple[int, ...]:
    """Return the robots that are able to act and that the participant has ignored for too long.

    Args:
        state: state of the game.
        attended: tick of the last event or request about each robot, by robot.
        tick: present tick.
        timeout: number of ticks for which a robot waits.
    """
    if state.ended is not None or state.treasures is None:
        return ()
    return tuple(
        number
        for number, robot in enumerate(state.robots)
        if robot.bound_for is None
        and not rules.unable(state, number)
        and not rules.commanded_by_other(state, number, Commander.PARTICIPANT)
        and tick - attended.get(number, tick) >= timeout
    )


def decide_about_treasure(state: GameState, robot: int, names: Collection[str]) -> AloneDecision | None:
    """Return a robot's decision about an undecided treasure in its present room, or None if it makes no decision.

    The robot senses the treasure, and names it if only one name fits. All other decisions are for a person.

    Args:
        state: state of the game.
        robot: index of the robot.
        names: names that fit the known properties of the treasure.
    """
    here = state.robots[robot].at
    if not state.has_room(here) or state.decider(here) != robot or state.room(here).is_decided:
        return None
    sensed = rules.sense(state, here) if state.room(here).sensed is None else ()
    if isinstance(sensed, tuple) and sensed:
        return AloneDecision(robot, here, sensed, departs=False)
    if len(names) == 1:
        named = rules.identify(state, here, next(iter(names)))
        if isinstance(named, tuple):
            return AloneDecision(robot, here, named, departs=False)
    return None


def decide_to_go(state: GameState, robot: int, room: Room) -> AloneDecision | None:
    """Return a robot's departure for a room, or None if the rules refuse it. Treasures stay undecided."""
    ruling = rules.move(state, robot, room)
    if not isinstance(ruling, tuple):
        return None
    events = tuple(event for event in ruling if not isinstance(event, TreasureLeft))
    return AloneDecision(robot, room, events, departs=True)
