"""`thbridge play`: a whole hunt in one program."""

import dataclasses
import math
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from thbridge.adapters.recordings import parts_of
from thbridge.adapters.text_server import CannotListen, Listening
from thbridge.app import play as hunt
from thbridge.app.fleet import RobotsFrom
from thbridge.app.play import Outcome, PlayOptions, Unfinished
from thbridge.app.session import Moment
from thbridge.wire import legacy
from ui.options import (
    AsJson,
    BagFile,
    MapName,
    Port,
    Robots,
    Ros,
    RosHost,
    RosMaster,
    Seed,
    StudyFile,
    Who,
    announce_compiling,
    graph_of,
    make_ready,
    setting_of,
    study_of,
    teller_of_masters,
    with_server,
    write_report,
)
from ui.seats import run, seat_of
from ui.story import tell
from ui.terminal import BAD_INPUT, FAILED, bad_input, fail, note, out, print_json

AN_HOUR = 3600.0


def play(
    study_file: StudyFile = None,
    robots: Robots = None,
    map_name: MapName = None,
    headless: Annotated[bool, typer.Option(help="Without a window; there is none yet.")] = False,
    participant: Annotated[
        Who | None, typer.Option(help="You (`person`), or how a simulated participant chooses rooms.")
    ] = None,
    seed: Seed = None,
    rate: Annotated[
        float | None,
        typer.Option(
            help="Simulated seconds per second; 0: full speed, the default unless people or other programs play.", min=0
        ),
    ] = None,
    bag: BagFile = None,
    outside: Annotated[
        str, typer.Option(help="Roles that other programs will take, e.g. `TabUI,Hider`.", metavar="ROLES")
    ] = "",
    port: Port = None,
    max_seconds: Annotated[
        float | None,
        typer.Option(
            help="Give up after so much simulated time; by default an hour, and never when people play.", min=1
        ),
    ] = None,
    report_page: Annotated[
        bool | None,
        typer.Option("--report/--no-report", help="Make a page of the bag; by default without --json."),
    ] = None,
    ros: Ros = False,
    ros_master: RosMaster = None,
    ros_host: RosHost = None,
    as_json: AsJson = False,
) -> None:
    """Play a whole hunt: all roles in one program, recorded into a bag.

    Other programs may join on the TCP port; those named by --outside take the place of ours.
    """
    study = with_server(study_of(study_file, {"robots": robots, "map": map_name, "seed": seed}), None, port)
    if study.robots_from is RobotsFrom.ROS:
        problem = "robots_from: this study is for real robots, and `play` simulates"
        fail(BAD_INPUT, f"{problem}. Start `thbridge server`, `simr`, `hider` and `tabui`, or write sim in the study.")
    setting = setting_of(study, study_file)
    others = _roles(outside)
    who = participant or Who(study.participant.strategy)
    seat = seat_of(who, setting.templates, study.seed)
    graph = graph_of(ros, ros_master, ros_host)
    people = bool(others) or who is Who.PERSON
    path = bag or Path("bags") / f"{setting.place.name}-{study.robots}robots-seed{study.seed}.bag"
    make_ready(path)

    def ready(where: Listening | CannotListen) -> None:
        if isinstance(where, CannotListen):
            if others:
                fail(BAD_INPUT, str(where))
            note(f"Nobody from outside can join: {where}")
        elif not as_json:
            note(f"Other programs can join at {where.host}:{where.port}.")

    def progress(moment: Moment) -> None:
        if not as_json and who is not Who.PERSON:
            for sentence in tell(moment):
                out.print(sentence, highlight=False, markup=False)

    limit = max_seconds or (math.inf if people else AN_HOUR)
    pace = next(given for given in (rate, study.rate, float(people or ros)) if given is not None)
    announce_compiling()
    unfinished: Unfinished | None = None
    try:
        options = PlayOptions(pace, path, others, who, limit, graph)
        program = hunt.play(setting, seat.tabui, options, ready, progress, teller_of_masters(graph, as_json))
        outcome = run(program, seat.typed)
    except Unfinished as early:
        outcome, unfinished = early.outcome, early
    if as_json:
        print_json(dataclasses.asdict(outcome) | {"bag": str(outcome.bag)})
    else:
        _show(outcome)
    stopped = unfinished is not None and unfinished.stopped
    if not stopped and (report_page or (report_page is None and not as_json)):
        with bad_input():
            write_report(path, path.with_suffix(".html"))
    if stopped:
        fail(FAILED, "stopped; what was recorded up to here is complete")
    if unfinished is not None:
        fail(FAILED, f"the game was not over after {limit:g} simulated seconds")


def _roles(names: str) -> frozenset[str]:
    chosen = frozenset(name.strip() for name in names.split(",") if name.strip())
    known = {legacy.TABUI, legacy.HIDER}
    wrong = sorted(chosen - known)
    if wrong:
        fail(BAD_INPUT, f"--outside: {wrong[0]} is not a role that can be left out here. Use TabUI or Hider.")
    return chosen


def _show(outcome: Outcome) -> None:
    table = Table(title="The hunt", show_header=False)
    table.add_row("score", str(outcome.score))
    table.add_row("rooms visited", str(outcome.rooms_visited))
    table.add_row("treasures named", str(outcome.identified))
    for robot, energy in enumerate(outcome.energy):
        table.add_row(f"energy of robot {robot + 1}", f"{energy:g}")
    table.add_row("simulated time", f"{outcome.sim_seconds:.1f} s in {outcome.wall_seconds:.1f} s")
    table.add_row("collisions", str(outcome.collisions))
    if outcome.bag is not None:
        first, *others = parts_of(outcome.bag)
        table.add_row("bag", f"{first} to {others[-1].name}" if others else str(first))
    out.print(table)
