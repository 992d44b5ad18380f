"""Rooms for `thbridge suggest`."""

from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.rooms import Room
from ui.terminal import BAD_INPUT, fail


def room_in(costs: CostMatrix, text: str) -> Room:
    """The room that a text names."""
    if not text.isdecimal() or (room := Room(int(text))) not in costs.rooms:
        wanted = f"Write numbers of rooms, 1 to {len(costs.rooms)}, with commas between"
        fail(BAD_INPUT, f"--unvisited: {text!r} is not a room in the cost file. {wanted}.")
    return room
