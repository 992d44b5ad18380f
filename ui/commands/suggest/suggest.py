"""`thbridge suggest`: suggest the next room."""

import math
from collections.abc import Collection
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from thbridge.hunt.team_planner import TeamPlanner
from ui.command_line.options import AsJson
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail, print_json, show

if TYPE_CHECKING:
    from thbridge.hunt.costs import CostMatrix
    from thbridge.hunt.refusals import RequestRefused
    from thbridge.hunt.rooms import Room
    from thbridge.hunt.tour import Tour


def suggest(
    costs: Annotated[Path | None, typer.Option(help="File of travel costs, in the mapTimes format.")] = None,
    at: Annotated[int | None, typer.Option(help="Room where the robot is; 0 is the corridor.", min=0)] = None,
    unvisited: Annotated[
        str | None, typer.Option(help="Unvisited rooms, for example `1,2,5`; default for a team: all rooms.")
    ] = None,
    team: Annotated[
        Path | None, typer.Option(help="Study file: plan for all its robots from their start poses.")
    ] = None,
    planner: Annotated[
        TeamPlanner | None,
        typer.Option(help="Method that divides rooms among robots; `joint` gives the best plan.", show_default="joint"),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Suggest the next room for a robot or a team: the first room of the cheapest tour of all unvisited rooms."""
    if team is not None:
        if costs is not None or at is not None:
            fail(BAD_INPUT, "--team: the study defines costs and start poses. Omit --costs and --at.")
        _suggest_to_team(team, unvisited, planner or TeamPlanner.JOINT, as_json)
        return
    if planner is not None:
        fail(BAD_INPUT, "--planner: this option applies only to a team. Add --team STUDY, or omit --planner.")
    if costs is None or at is None or unvisited is None:
        fail(BAD_INPUT, "suggest: for one robot, write --costs, --at and --unvisited; for a team, write --team STUDY.")
    _suggest_to_robot(costs, at, unvisited, as_json)


def _suggest_to_robot(costs: Path, at: int, unvisited: str, as_json: bool) -> None:
    from thbridge.files.map_times import read_map_times
    from thbridge.hunt.refusals import RequestRefused
    from thbridge.hunt.rooms import Room
    from thbridge.hunt.tour import MOST_ROOMS, best_tour

    with bad_input():
        matrix = read_map_times(costs)
    start = Room(at)
    if not matrix.has_place(start):
        fail(
            BAD_INPUT,
            f"--at: {at} is not a place in the cost file. Write 0, the corridor, or a room up to {len(matrix.rooms)}.",
        )
    places = _rooms(unvisited, matrix.rooms)
    compared = len({*places} - {start}) <= MOST_ROOMS
    tour = best_tour(matrix, start, places) if compared else _good_tour(matrix, start, places)
    if isinstance(tour, RequestRefused):
        fail(FAILED, tour.sentence)
    visits_all = {*tour.rooms} == {*places} - {start}
    # If some rooms are unreachable, no bound is known for a tour of the reachable rooms.
    least = tour.cost if compared else None
    if visits_all and not compared:
        # Only the bound needs scipy. Importing scipy takes longer than finding most tours.
        from thbridge.hunt.tour_bound import least_tour_cost

        least = least_tour_cost(matrix, start, places, tour.cost)
    proven = least == tour.cost
    rooms = [each.people for each in tour.rooms]
    if as_json:
        result = {"next": rooms[0], "tour": rooms, "cost": _plain(tour.cost), "proven": proven}
        print_json(result | {"at_least": None if least is None else _plain(least)})
        return
    kind = "The cheapest" if proven else "A good"
    show(f"Next room: {rooms[0]}. {kind} tour is {' '.join(map(str, rooms))} and costs {_plain(tour.cost)}.")
    if least is None:
        show("There are too many rooms to prove that this tour is the cheapest. A cheaper tour may exist.")
    elif not proven:
        over = 100.0 * (tour.cost / least - 1.0) if least > 0.0 else math.inf
        show(
            f"No tour costs less than {least:g}, so this tour is at most {over:.1f} % more expensive than the cheapest "
            "tour."
        )


def _plain(cost: float) -> float:
    return int(cost) if cost == int(cost) else cost


def _good_tour(costs: "CostMatrix", at: "Room", unvisited: Collection["Room"]) -> "Tour | RequestRefused":
    from thbridge.hunt.team_tour import TourStart
    from thbridge.hunt.team_tour_search import search_team_tours
    from thbridge.hunt.tour import why_no_tour

    row = costs.rows[at.people]
    rooms = set(unvisited) - {at}
    return why_no_tour(row, at, rooms) or search_team_tours(costs, (TourStart(row, math.inf),), rooms)[0]


def _suggest_to_team(study_file: Path, unvisited: str | None, planner: TeamPlanner, as_json: bool) -> None:
    from ui.command_line.settings import setting_of, study_of
    from ui.commands.suggest.plan import plan_as_json, plan_of, show_plan

    setting = setting_of(study_of(study_file, {}), study_file)
    rooms = setting.costs.rooms if unvisited is None else _rooms(unvisited, setting.costs.rooms)
    plan = plan_of(setting, rooms, planner)
    if as_json:
        print_json(plan_as_json(plan))
    else:
        show_plan(plan, setting.map.room_names)


def _rooms(text: str, known: Collection["Room"]) -> list["Room"]:
    from thbridge.hunt.rooms import Room

    rooms = []
    for number in map(str.strip, text.split(",")):
        if not number.isdecimal() or (room := Room(int(number))) not in known:
            wanted = f"Write numbers of rooms, 1 to {len(known)}, separated by commas"
            fail(BAD_INPUT, f"--unvisited: {number!r} is not a room in the cost file. {wanted}.")
        rooms.append(room)
    return rooms
