"""The commands about files: reports, maps, studies, costs, ROS message types."""

from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from ui.commands.group import CommandGroup
from ui.options import AsJson
from ui.outputs import STANDARD_OUTPUT
from ui.terminal import BAD_INPUT, FAILED, bad_input, fail, note, out, print_json, say

maps_app = typer.Typer(
    cls=CommandGroup,
    help="Maps: the arenas that robots drive in.",
    no_args_is_help=True,
)
study_app = typer.Typer(
    cls=CommandGroup,
    help="Study files: everything that can be set, in one YAML file.",
    no_args_is_help=True,
)


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
        out.print(f"Next room {rooms[0]}; the cheapest tour is {' '.join(map(str, rooms))} and costs {cost}.")


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


@maps_app.command("check")
def maps_check(
    name: Annotated[str, typer.Argument(help="Name of a map, or the path of its folder.")],
    to: Annotated[
        Path | None,
        typer.Option("--to", help="Draw the map there: rooms, numbers, names, doors, goals, starts; .png, .svg, .pdf."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check a map: image, rooms, goals and start poses; and tell what it holds."""
    from thbridge.files.map_files import check_map
    from thbridge.offline.map_survey import survey
    from ui.actions.map_check import PICTURES, finding_as_json, show_survey, survey_as_json, write_picture
    from ui.settings import map_folder

    if to is not None and to.suffix.lower() not in PICTURES:
        fail(BAD_INPUT, f"--to: {to} is no picture. Give a file name that ends in .png, .svg or .pdf.")
    folder = map_folder(name)
    check = check_map(folder)
    seen = None if check.map is None else survey(check.map)
    errors = len(check.errors)
    if as_json:
        told = None if seen is None else survey_as_json(seen)
        print_json({"ok": errors == 0, "findings": [finding_as_json(each) for each in check.findings], "map": told})
    else:
        if seen is not None and not errors:
            show_survey(seen, folder)
        for finding in check.findings:
            say(f"{finding.severity}: {finding.fault}")
        say(f"{errors} errors, {len(check.findings) - errors} warnings")
    if to is not None and seen is None:
        note(f"{to} is not drawn: first the files must be readable.")
    elif to is not None and seen is not None:
        with bad_input():
            write_picture(seen, to)
        note(f"Wrote {to}.")
    if errors:
        raise typer.Exit(BAD_INPUT)


@maps_app.command("list")
def maps_list() -> None:
    """Name the maps that come with the project."""
    from thbridge.files.resources import shipped

    for name in shipped().names("maps"):
        out.print(name)


@study_app.command("init")
def study_init(
    file: Annotated[Path, typer.Argument(help="The file to write; must not exist. `-` is standard output.")],
) -> None:
    """Write a study file with every key at its default, commented."""
    from thbridge.study.text import commented_study

    if file == STANDARD_OUTPUT:
        print(commented_study(), end="")  # noqa: T201 - this is what was asked for
        return
    try:
        with file.open("x", encoding="utf-8") as opened:
            opened.write(commented_study())
    except FileExistsError:
        fail(BAD_INPUT, f"{file}: there is such a file already. Choose another name.")
    except OSError as error:
        with suppress(OSError):
            file.unlink()  # a half written one
        fail(BAD_INPUT, f"{file}: it cannot be written ({error.strerror}). Choose another folder.")
    note(f"Wrote {file}. Run it with `thbridge play {file}`.")


@study_app.command("check")
def study_check(file: Annotated[Path, typer.Argument(help="A study file.")]) -> None:
    """Check a study file and everything it names."""
    from ui.settings import setting_of, study_of

    setting_of(study_of(file, {}), file)
    out.print(f"{file}: no faults", highlight=False)
