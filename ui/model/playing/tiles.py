"""Buttons of the rooms, the button that asks for advice, and the button that ends the game."""

from collections.abc import Mapping

from thbridge.dialogue.wording.texts import Texts
from thbridge.roles.shared.view import EndGame, RequestSuggestion, RoomView, SelectRoom, View
from ui.model.playing.keys import keyed
from ui.model.playing.memory.state import HuntMemory, ParticipantMemory
from ui.model.playing.possible import energy_warning, why_not_ask, why_not_end, why_not_go
from ui.model.playing.screen import Action, EndGameAct, RequestSuggestionAct, RoomTile, SelectRoomAct
from ui.model.playing.seat_view import sees_energy, sees_score
from ui.model.playing.votes import vote_on_end
from ui.model.shared.points import gained
from ui.model.shared.scene import decided


def tiles(memory: ParticipantMemory, hunt: HuntMemory) -> tuple[RoomTile, ...]:
    """Return one tile per room, room 1 first."""
    team = hunt.view.team
    names = {} if team is None else dict(enumerate(team.room_names, 1))
    if memory.floor_plan is not None:
        names = {room.room: room.name for room in memory.floor_plan.rooms}
    return tuple(_tile(memory, hunt, room, names) for room in hunt.view.rooms)


def dont_know(memory: ParticipantMemory, hunt: HuntMemory) -> Action:
    """Return the button that asks the selected robot for advice."""
    robot = memory.selected
    refused = why_not_ask(hunt.texts, hunt.known, robot)
    asked = isinstance(hunt.pending.destination_request(robot), RequestSuggestion)
    hint = hunt.texts.text("tiles.dont_know_hint", robot=robot) if refused is None else refused
    return keyed(RequestSuggestionAct(), hunt.texts.text("tiles.dont_know"), refused is None and not asked, hint, asked)


def end(hunt: HuntMemory) -> Action:
    """Return the button that ends the game."""
    refused = why_not_end(hunt.texts, hunt.known) or vote_on_end(hunt)
    asked = EndGame(hunt.view.game) in hunt.pending
    hint = hunt.texts.text("tiles.end_hint") if refused is None else refused
    return keyed(EndGameAct(), hunt.texts.text("tiles.end"), refused is None and not asked, hint, asked)


def _tile(memory: ParticipantMemory, hunt: HuntMemory, room: RoomView, names: Mapping[int, str]) -> RoomTile:
    robot = memory.selected
    mover = hunt.view.robots[robot]
    refused = why_not_go(hunt.texts, hunt.known, robot, room.room)
    warning = "" if refused else energy_warning(hunt.texts, hunt.known, robot, room.room)
    found, *shorter = _found(hunt.texts, hunt.view, room)
    costs = hunt.view.costs_from(mover) if mover.moving_to is None else hunt.view.costs_when_stopped()
    return RoomTile(
        room=room.room,
        name=names.get(room.room) or hunt.texts.text("window.room", room=room.room),
        state=room.state if room.verdict is None else decided(room.verdict.points),
        robot=room.robot,
        cost=costs[room.room] if costs is not None and room.state == "unvisited" and sees_energy(hunt.view) else None,
        considered=room.room == (memory.considered() or hunt.destination_considered(robot)),
        found=found,
        found_shorter=tuple(shorter),
        choose=_choose(hunt, robot, room.room, refused, warning),
        warning=warning,
        reachable=costs is None or costs[room.room] is not None,
    )


def _choose(hunt: HuntMemory, robot: int, room: int, refused: str | None, warning: str) -> Action:
    busy = SelectRoom(robot, room) in hunt.pending or hunt.reroutes.get(robot) == room
    # While a question asks for confirmation, the request has not been sent to the robot.
    discussed = hunt.pending_step is None and hunt.destination_considered(robot) == room
    if refused is not None:
        hint = refused
    elif busy:
        hint = hunt.texts.text("tiles.asking", robot=robot)
    elif discussed:
        hint = hunt.texts.text("tiles.discussed", robot=robot)
    else:
        hint = _price(hunt, robot, room, warning)
    key = str(room).zfill(len(str(len(hunt.view.rooms))))
    return Action(
        SelectRoomAct(room), hunt.texts.text("window.room", room=room), key, refused is None and not busy, hint, busy
    )


def _price(hunt: HuntMemory, robot: int, room: int, warning: str) -> str:
    texts, mover = hunt.texts, hunt.view.robots[robot]
    if mover.moving_to is not None:
        return texts.text("tiles.called_back_first", robot=robot, room=mover.moving_to)
    if not sees_energy(hunt.view):
        return texts.text("seats.send_there", robot=robot, room=room)
    cost = hunt.view.costs_from(mover)[room] or 0.0
    hint = texts.text("tiles.price", robot=robot, cost=cost, energy=mover.energy - cost)
    return f"{hint} {warning}".rstrip()


def _found(texts: Texts, view: View, room: RoomView) -> tuple[str, ...]:
    """Return texts of decreasing length about the known properties of the treasure in a room."""
    if room.verdict is not None:
        name, points = view.word_for(room.verdict.name) or texts.text("tiles.named"), gained(room.verdict.points)
        if not sees_score(view):
            return (name,)
        return f"{name}, {points}", name, points
    if room.left:
        return (texts.text("tiles.left"),)
    if not room.found:
        return ("",)
    value = next((each.word(room.known[each.name]) for each in view.properties if each.name in room.known), "")
    return (texts.clause("tiles.found_with", value=value), value) if value else (texts.text("tiles.found"),)
