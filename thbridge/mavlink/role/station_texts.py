"""Texts about the game for people at ground stations: reached rooms, found treasures, results."""

from collections.abc import Iterator

from sim.common.robot_numbers import robot_name
from thbridge.hunt.events import Commander
from thbridge.hunt.game import GameState, RoomState
from thbridge.hunt.properties import properties_in_words
from thbridge.hunt.rooms import Room
from thbridge.hunt.seats import capitalized
from thbridge.hunt.treasures import name_in_words


def game_texts(robot: int, before: GameState | None, now: GameState) -> Iterator[str]:
    """Yield sentences about changes since `before` of a robot and of the room where it stands."""
    if before is None or before.started != now.started:
        return
    was, mover = before.robots[robot], now.robots[robot]
    if was.bound_for is not None and mover.bound_for is None and mover.at == was.bound_for:
        yield f"{robot_name(robot).capitalize()} is in {mover.at}."
    if mover.bound_for is None and now.has_room(mover.at):
        yield from _room_news(now, mover.at, before.room(mover.at), now.room(mover.at))
    if now.ended is not None and before.ended is None:
        yield f"The game is over. The score is {now.score}."


def handback_texts(robot: int, before: GameState | None, now: GameState) -> Iterator[str]:
    """Yield the participants' requests since `before` to get a robot back from the ground station that commands it."""
    if before is None or now.robots[robot].holder.by is not Commander.GROUND_STATION:
        return
    if now.robots[robot].asked_back > before.robots[robot].asked_back:
        yield f"{capitalized(now.label_of(now.robots[robot].asked_by))} asks for {robot_name(robot)} back."


def _room_news(state: GameState, room: Room, was: RoomState, now: RoomState) -> Iterator[str]:
    name = str(room).capitalize()
    if now.sensed is not None and was.sensed != now.sensed:
        yield f"{name}: {properties_in_words(state.started.properties, now.sensed)}."
    if now.image is not None and was.image is None:
        yield f"{name}: a picture was taken."
    if now.points is not None and was.points is None:
        yield f"{name}: {name_in_words(now.name or 'named')}, {now.points:+d} points."
    if now.left and not was.left:
        yield f"{name}: what is there is left there."
    if was.left and not now.left:
        yield f"{name}: what is there is taken up again."
