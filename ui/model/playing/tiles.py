"""Buttons of the rooms, and the two that go with them: asking for advice, ending the game."""

from collections.abc import Mapping

from sim.common.robot_numbers import robot_name
from thbridge.hunt.costs import energy_text
from thbridge.hunt.properties import value_in_words
from thbridge.hunt.treasures import name_in_words
from thbridge.roles.view import GiveUp, RequestSuggestion, RoomView, SelectRoom
from ui.model.keys import keyed
from ui.model.playing.memory.state import HuntMemory, ParticipantMemory
from ui.model.playing.possible import energy_warning, why_not_ask, why_not_end, why_not_go
from ui.model.playing.words import gained, place_name, titled
from ui.model.scene import decided
from ui.model.screen import Action, AskAdvice, ChooseRoom, EndGame, RoomTile


def tiles(memory: ParticipantMemory, hunt: HuntMemory) -> tuple[RoomTile, ...]:
    """One tile per room, room 1 first."""
    names = {} if memory.floor_plan is None else {room.room: room.name for room in memory.floor_plan.rooms}
    return tuple(_tile(memory, hunt, room, names) for room in hunt.view.rooms)


def dont_know(memory: ParticipantMemory, hunt: HuntMemory) -> Action:
    """The action that asks the selected robot for its advice."""
    robot = memory.selected
    refused = why_not_ask(hunt.known, robot)
    asked = isinstance(hunt.pending.destination_request(robot), RequestSuggestion)
    hint = f"{titled(robot)} suggests where to go." if refused is None else refused
    return keyed(AskAdvice(), "Don't know", refused is None and not asked, hint, asked)


def end(hunt: HuntMemory) -> Action:
    """The action that ends the game."""
    refused = why_not_end(hunt.known)
    asked = GiveUp(hunt.view.game) in hunt.pending
    hint = "End the game as it stands." if refused is None else refused
    return keyed(EndGame(), "End game", refused is None and not asked, hint, asked)


def _tile(memory: ParticipantMemory, hunt: HuntMemory, room: RoomView, names: Mapping[int, str]) -> RoomTile:
    robot = memory.selected
    mover = hunt.view.robots[robot]
    costs = hunt.view.costs_from(mover) if mover.moving_to is None else hunt.view.costs_when_stopped()
    return RoomTile(
        room=room.room,
        name=names.get(room.room) or f"Room {room.room}",
        state=room.state if room.verdict is None else decided(room.verdict.points),
        robot=room.robot,
        cost=costs[room.room] if costs is not None and room.state == "unvisited" else None,
        considered=room.room == (memory.considered() or hunt.destination_considered(robot)),
        found=_found(room),
        choose=_choose(memory, hunt, room),
        warning="" if why_not_go(hunt.known, robot, room.room) else energy_warning(hunt.known, robot, room.room),
    )


def _choose(memory: ParticipantMemory, hunt: HuntMemory, room: RoomView) -> Action:
    robot, number = memory.selected, room.room
    refused = why_not_go(hunt.known, robot, number)
    busy = SelectRoom(robot, number) in hunt.pending or hunt.reroutes.get(robot) == number
    discussed = hunt.destination_considered(robot) == number
    if refused is not None:
        hint = refused
    elif busy:
        hint = f"Asking {robot_name(robot)}."
    elif discussed:
        hint = f"You are talking with {robot_name(robot)} about this room."
    else:
        hint = _price(hunt, robot, number)
    key = str(number).zfill(len(str(len(hunt.view.rooms))))
    return Action(ChooseRoom(number), f"Room {number}", key, refused is None and not busy, hint, busy)


def _price(hunt: HuntMemory, robot: int, room: int) -> str:
    view, mover = hunt.view, hunt.view.robots[robot]
    if mover.moving_to is not None:
        return f"{titled(robot)} is on its way to {place_name(mover.moving_to)} and would be called back first."
    cost = view.costs_from(mover)[room] or 0.0
    left = mover.energy - cost
    hint = f"Costs {energy_text(cost)}; {robot_name(robot)} keeps {energy_text(left)}."
    return f"{hint} {energy_warning(hunt.known, robot, room)}".rstrip()


def _found(room: RoomView) -> str:
    if room.verdict is not None:
        return f"{name_in_words(room.verdict.name) or 'named'}, {gained(room.verdict.points)}"
    if room.left:
        return "left there"
    return f"something {value_in_words(next(iter(room.known.values()), ''))}".rstrip() if room.found else ""
