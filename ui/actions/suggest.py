"""Joint plans of `thbridge suggest --team`."""

import math
from collections.abc import Mapping, Sequence

from rich.table import Table

from sim.common.robot_numbers import number_of, robot_name
from thbridge.app.compose.robots import build_travel_times
from thbridge.app.compose.setting import StudySetting
from thbridge.hunt.costs import energy_text
from thbridge.hunt.rooms import CORRIDOR, Room, RoomNames
from thbridge.hunt.team_tour import PlanValue, TourStart
from thbridge.hunt.tour import Tour
from ui.terminal import out, show

Alternatives = Sequence[Mapping[Room, PlanValue]]
"""What each next room of each robot is worth."""


def team_starts(setting: StudySetting) -> tuple[TourStart, ...]:
    """Return where the tours of a study's robots begin, as its game reckons what they cost."""
    study, corridor = setting.study, tuple(setting.costs.rows[CORRIDOR.people])
    if not setting.by_position:
        return (TourStart(corridor, study.game.energy),) * study.robots
    travel = build_travel_times(setting)
    rows = (travel.costs_from(start) for start in setting.map.starts[: study.robots])
    return tuple(
        TourStart(tuple(math.inf if cost is None else cost for cost in row), study.game.energy) for row in rows
    )


def plan_as_json(tours: Sequence[Tour], values: Alternatives) -> dict[str, object]:
    """Return the plan as the JSON object has it."""
    robots = [
        {
            "robot": number_of(robot),
            "tour": [room.people for room in tour.rooms],
            "cost": tour.cost,
            "alternatives": [
                {"next": room.people, "rooms": value.rooms, "cost": value.cost} for room, value in of_robot.items()
            ],
        }
        for robot, (tour, of_robot) in enumerate(zip(tours, values, strict=True))
    ]
    rooms = sum(len(tour.rooms) for tour in tours)
    return {"rooms": rooms, "cost": sum(tour.cost for tour in tours), "robots": robots}


def show_plan(tours: Sequence[Tour], values: Alternatives, names: RoomNames) -> None:
    """Print each robot's tour, and what its other next rooms would cost the team."""
    total, spent = sum(len(tour.rooms) for tour in tours), sum(tour.cost for tour in tours)
    table = Table(title=f"{total} rooms for {energy_text(spent)} energy", title_justify="left")
    for heading in ("", "tour", "energy", "what other rooms first would cost the team"):
        table.add_column(heading)
    for robot, (tour, of_robot) in enumerate(zip(tours, values, strict=True)):
        first = tour.rooms[0] if tour.rooms else None
        others = {room: value for room, value in of_robot.items() if room != first}
        told = ", ".join(f"{room.people}: {_loss(value, total, spent)}" for room, value in others.items())
        way = " ".join(str(room.people) for room in tour.rooms) or "stays"
        table.add_row(robot_name(robot), way, energy_text(tour.cost), told)
    out.print(table)
    sent = [(at, tour.rooms[0].people) for at, tour in enumerate(tours) if tour.rooms]
    told = "; ".join(f"{robot_name(at)} to {names.titled(room)}" for at, room in sent)
    show(f"Next: {told or 'nobody goes anywhere'}.")


def _loss(value: PlanValue, rooms: int, spent: float) -> str:
    fewer = rooms - value.rooms
    if fewer:
        return f"{fewer} room{'s' if fewer > 1 else ''}"
    more = value.cost - spent
    return f"{energy_text(more)} energy" if more > 0.0 else "nothing"
