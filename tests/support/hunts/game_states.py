"""States of games without robots, and the effects of rulings on them."""

from collections.abc import Iterable
from functools import reduce

from tests.support.project import ROOT
from thbridge.files.map_times import read_map_times
from thbridge.hunt import rules
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import (
    EndReason,
    Event,
    GameEnded,
    GameStarted,
    RobotArrived,
    RobotDeparted,
    TreasureIdentified,
    TreasuresHidden,
)
from thbridge.hunt.game import GameState, apply, begin
from thbridge.hunt.refusals import RequestRefused
from thbridge.hunt.rooms import Room, all_rooms
from thbridge.hunt.treasures import TreasureKind

ARENA = read_map_times(ROOT / "templates" / "original-2016" / "mapTimes")
ORANGE = TreasureKind({"colour": "Orange", "footprint": "Round and Large"}, 10, "Orange Bottle", "rsz_t1.jpg")
PINK = TreasureKind({"colour": "Pink", "footprint": "Square and Small"}, 30, "Pink can", "rsz_t4.jpg")
ROOM_1, ROOM_2, ROOM_3, ROOM_4 = all_rooms(4)


def new_game(robots=2, energy=100.0, picture_cost=5.0, identify_cost=2.0, wrong_share=1.0, costs=ARENA):
    started = GameStarted(7, 1, robots, energy, picture_cost, identify_cost, wrong_share, costs)
    return apply(begin(started), TreasuresHidden((PINK, ORANGE) * (len(costs.rooms) // 2)))


def after(state, ruling):
    assert not isinstance(ruling, RequestRefused), ruling
    for event in ruling:
        state = apply(state, event)
    return state


def visit(state, robot, room):
    state = after(state, rules.move(state, robot, room))
    return after(state, rules.arrive(state, robot, room))


def in_room_4(**options):
    state = visit(new_game(**options), 0, ROOM_4)
    return after(state, rules.sense(state, ROOM_4))


def small_game(**options):
    return new_game(
        robots=1, costs=CostMatrix.of_map_times(((99.0, 5.0, 9.0), (99.0, 99.0, 5.0), (99.0,) * 3)), **options
    )


def fold(started: GameStarted, events: Iterable[Event]) -> GameState:
    return reduce(apply, events, begin(started))


COSTS = CostMatrix.of_map_times(((99.0, 5.0, 9.0), (99.0, 99.0, 5.0), (99.0, 4.0, 99.0)))
STARTED = GameStarted(7, 1, 2, 100.0, 5.0, 2.0, 1.0, COSTS)
EVENTS = (
    RobotDeparted(0, Room(1), 5.0),
    RobotArrived(0, Room(1)),
    TreasureIdentified(Room(1), 0, "Größe\n", 10, 2.0),
    GameEnded(EndReason.ALL_VISITED, 10),
)
