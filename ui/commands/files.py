"""The commands about single files: reports of bags, tours by costs."""

from pathlib import Path
from typing import Annotated

import typer

from ui.options import AsJson
from ui.terminal import BAD_INPUT, FAILED, bad_input, fail, print_json, show


def suggest(
    costs: Annotated[Path, typer.Option(help="Cost file in the mapTimes format.")],
    at: Annotated[int, typer.Option(help="Where the robot stands; 0 is the corridor.", min=0)],
    unvisited: Annotated[str, typer.Option(help="Rooms still to visit, e.g. `1,2,5`.")],
    as_json: AsJson = False,
) -> None:
    """Suggest the next room: the first of the cheapest tour of all rooms still to visit."""
    from thbridge.files.map_times import read_map_times
    from thbridge.hunt.refusals import RequestRefused
    from thbridge.hunt.rooms import Room
    from thbridge.hunt.tour import best_tour

    with bad_input():
        matrix = read_map_times(costs)
    start = Room(at)
    if not matrix.has_place(start):
        fail(
            BAD_INPUT,
            f"--at: {at} is not a place in the cost file. Write 0, the corridor, or a room up to {len(matrix.rooms)}.",
        )
    places = []
    for text in map(str.strip, unvisited.split(",")):
        if not text.isdecimal() or (room := Room(int(text))) not in matrix.rooms:
            wanted = f"Write numbers of rooms, 1 to {len(matrix.rooms)}, with commas between"
            fail(BAD_INPUT, f"--unvisited: {text!r} is not a room in the cost file. {wanted}.")
        places.append(room)
    tour = best_tour(matrix, start, places)
    if isinstance(tour, RequestRefused):
        fail(FAILED, tour.sentence)
    rooms = [each.people for each in tour.rooms]
    cost = int(tour.cost) if tour.cost == int(tour.cost) else tour.cost
    if as_json:
        print_json({"next": rooms[0], "tour": rooms, "cost": cost})
    else:
        show(f"Next room {rooms[0]}; the cheapest tour is {' '.join(map(str, rooms))} and costs {cost}.")


def report(
    bag: Annotated[Path, typer.Argument(help="A ROS 1 bag.")],
    to: Annotated[
        Path | None, typer.Option("--to", help="The page; by default beside the bag. `-` is standard output.")
    ] = None,
    map_yaml: Annotated[
        Path | None, typer.Option("--map", help="The map, a map_server YAML file; by default the bag's own.")
    ] = None,
) -> None:
    """Make a report of a bag: one HTML page with paths, errors, energy, events and talk."""
    from ui.report import write_report

    with bad_input():
        write_report(bag, to or bag.with_suffix(".html"), map_yaml)
