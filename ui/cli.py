"""The command line: `thbridge`."""

import asyncio
import dataclasses
import json
import logging
import math
import secrets
import sys
from collections.abc import Callable, Coroutine, Iterator, Mapping
from contextlib import contextmanager
from enum import StrEnum
from pathlib import Path
from typing import Annotated, NoReturn, TypeVar

import msgspec
import typer
from rich.console import Console
from rich.logging import RichHandler
from rich.table import Table

from sim import is_compiled
from thbridge.adapters.bag_reader import info as bag_info
from thbridge.adapters.bag_repair import reindex as reindex_bag
from thbridge.adapters.errors import BadFile
from thbridge.adapters.map_files import check_map
from thbridge.adapters.resources import shipped
from thbridge.adapters.ros_package import write_package
from thbridge.adapters.template_files import TemplateSet, read_map_times, read_template_set
from thbridge.adapters.text_client import Lost
from thbridge.adapters.text_server import DEFAULT_HOST, DEFAULT_PORT, CannotListen, Listening
from thbridge.app import programs
from thbridge.app.compose import Setting, build_bot, build_hider, read_setting
from thbridge.app.config import Study, commented_study, read_study
from thbridge.app.programs import Interrupted, Outcome, PlayOptions, Unfinished
from thbridge.app.session import Moment
from thbridge.hunt.outcomes import Refused
from thbridge.hunt.rooms import Room
from thbridge.hunt.tour import best_tour
from thbridge.roles.tabui import TabUI
from thbridge.roles.view import View
from thbridge.study.bots import BotStrategy
from thbridge.wire import legacy
from ui.person import Person
from ui.story import tell

FAILED = 1
BAD_INPUT = 2

T = TypeVar("T")

app = typer.Typer(
    name="thbridge",
    help="A treasure hunt shared by people and teams of robots: simulate it, play it, record it.",
    no_args_is_help=True,
    rich_markup_mode="rich",
    pretty_exceptions_enable=False,
)
bag_app = typer.Typer(help="Look into recordings and mend them.", no_args_is_help=True)
maps_app = typer.Typer(help="Maps: the arenas that robots drive in.", no_args_is_help=True)
ros_app = typer.Typer(help="Where a ROS 1 is installed: make it know our messages.", no_args_is_help=True)
study_app = typer.Typer(help="Study files: everything that can be set, in one YAML file.", no_args_is_help=True)
app.add_typer(bag_app, name="bag")
app.add_typer(maps_app, name="maps")
app.add_typer(study_app, name="study")
app.add_typer(ros_app, name="ros")

out = Console()
err = Console(stderr=True)

StudyFile = Annotated[
    Path | None, typer.Argument(help="Study file (YAML); see `thbridge study init`. Options below win over it.")
]
Robots = Annotated[int | None, typer.Option(help="Size of the team.", min=1)]
MapName = Annotated[str | None, typer.Option("--map", help="Name of a map, or path of its folder (with a slash).")]
Seed = Annotated[int | None, typer.Option(help="Same seed, same study, same inputs: the same run.", min=0)]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object on standard output, nothing else.")]
Server = Annotated[str, typer.Option("--server", help="Where the text server is, HOST:PORT.", metavar="HOST:PORT")]
StudyOption = Annotated[Path | None, typer.Option("--study", help="Study file (YAML).")]
Templates = Annotated[str | None, typer.Option(help="Name of a set of templates, or path of its folder.")]
ADDRESS = f"{DEFAULT_HOST}:{DEFAULT_PORT}"


class Who(StrEnum):
    """Who sits in front of TabUI: a person who types, or a simulated participant."""

    PERSON = "person"
    SUGGESTION = BotStrategy.SUGGESTION
    NEAREST = BotStrategy.NEAREST
    RANDOM = BotStrategy.RANDOM


@app.command()
def play(
    study_file: StudyFile = None,
    robots: Robots = None,
    map_name: MapName = None,
    headless: Annotated[bool, typer.Option(help="Without a window.")] = False,
    participant: Annotated[
        Who | None, typer.Option(help="You (`person`), or how a simulated participant chooses rooms.")
    ] = None,
    seed: Seed = None,
    rate: Annotated[
        float | None, typer.Option(help="Simulated seconds per second; 0, the headless default: full speed.", min=0)
    ] = None,
    bag: Annotated[Path | None, typer.Option(help="Where to record. An older file is kept under a new name.")] = None,
    outside: Annotated[
        str, typer.Option(help="Roles that other programs will take, e.g. `TabUI,Hider`.", metavar="ROLES")
    ] = "",
    port: Annotated[int | None, typer.Option(help="TCP port for other programs; 0 takes a free one.", min=0)] = None,
    max_seconds: Annotated[
        float | None,
        typer.Option(
            help="Give up after so much simulated time; by default an hour, and never when people play.", min=1
        ),
    ] = None,
    report_page: Annotated[bool, typer.Option("--report/--no-report", help="Make a report page of the bag.")] = True,
    as_json: AsJson = False,
) -> None:
    """Play a whole hunt: all roles in one program, recorded into a bag.

    Other programs may join on the TCP port; those named by --outside take the place of ours.
    """
    changes: dict[str, object] = {"robots": robots, "map": map_name, "seed": seed}
    study = _study(study_file, changes)
    if port is not None:
        study = dataclasses.replace(study, server=dataclasses.replace(study.server, port=port))
    setting = _setting(study, study_file)
    others = _roles(outside)
    person = participant is Who.PERSON
    who = participant or Who(study.participant.strategy)
    seat = _seat(who, setting.templates, study.seed)
    chosen_rate = rate if rate is not None else (1.0 if others or person else 0.0)
    path = bag or Path("bags") / f"{setting.place.name}-{study.robots}robots-seed{study.seed}.bag"
    _prepare(path)

    def ready(where: Listening | CannotListen) -> None:
        if isinstance(where, CannotListen):
            if others:
                _fail(BAD_INPUT, str(where))
            err.print(f"Nobody from outside can join: {where}", style="yellow", highlight=False)
        elif not as_json:
            err.print(f"Other programs can join at {where.host}:{where.port}.", highlight=False)

    def progress(moment: Moment) -> None:
        if not as_json and not person:
            for sentence in tell(moment):
                out.print(sentence, highlight=False, markup=False)

    limit = max_seconds or (math.inf if others or person else 3600.0)
    _announce_compiling()
    options = PlayOptions(chosen_rate, path, others, limit)
    try:
        program = programs.play(setting, seat.tabui, options, ready, progress)
        outcome, unfinished = _run(_with_keyboard(program, seat.typed)), False
    except Unfinished as late:
        outcome, unfinished = late.outcome, True
    if as_json:
        _print_json(dataclasses.asdict(outcome) | {"bag": str(outcome.bag)})
    else:
        _show_outcome(outcome)
    if report_page and not as_json:
        _write_report(path, path.with_suffix(".html"))
    if unfinished:
        _fail(FAILED, f"the game was not over after {limit:g} simulated seconds")


@app.command()
def server(
    study_file: StudyFile = None,
    host: Annotated[str | None, typer.Option(help="Address to listen on; 0.0.0.0 lets other machines in.")] = None,
    port: Annotated[int | None, typer.Option(help="TCP port; 0 takes a free one.", min=0)] = None,
    journal: Annotated[Path, typer.Option(help="Folder of the games' journals.")] = Path("journal"),
    new_game: Annotated[bool, typer.Option("--new-game", help="Do not go on with an unfinished game.")] = False,
) -> None:
    """Run the text server of 2016, and with it the keeper of the game, until stopped."""
    study = _study(study_file, {})
    place = dataclasses.replace(
        study.server,
        host=study.server.host if host is None else host,
        port=study.server.port if port is None else port,
    )
    setting = _setting(dataclasses.replace(study, server=place), study_file)

    def ready(where: Listening | CannotListen) -> None:
        if isinstance(where, CannotListen):
            _fail(BAD_INPUT, str(where))
        print(f"listening on {where.host}:{where.port}", flush=True)  # noqa: T201 - programs wait for this line

    _run(programs.serve(setting, journal, new_game, ready))


@app.command()
def simr(
    study_file: StudyOption = None,
    server: Server = ADDRESS,
    robots: Robots = None,
    map_name: MapName = None,
    rate: Annotated[float, typer.Option(help="Simulated seconds per second.", min=0.01)] = 1.0,
    seed: Seed = None,
    bag: Annotated[Path | None, typer.Option(help="Where to record. An older file is kept under a new name.")] = None,
) -> None:
    """Run the robots (SimR) at a text server until stopped."""
    host, port = _address(server)
    setting = _setting(_study(study_file, {"robots": robots, "map": map_name, "seed": seed}), study_file)
    if bag is not None:
        _prepare(bag)
    _announce_compiling()
    unfit = _run(programs.simr(setting, host, port, _token(), rate, bag, _lost))
    if unfit is not None:
        _fail(FAILED, unfit)


@app.command()
def hider(
    server: Server = ADDRESS,
    treasures: Annotated[str | None, typer.Option(help="Set of templates, or its folder, with `treasures`.")] = None,
    seed: Seed = None,
) -> None:
    """Run the treasures' program (Hider) at a text server until stopped."""
    host, port = _address(server)
    default = Study()
    with _bad_input():
        templates = read_template_set(shipped().find("templates", treasures or default.templates, Path()))
    role = build_hider(templates, default.seed if seed is None else seed)
    _run(programs.hider(role, host, port, _token(), _lost))


@app.command()
def tabui(
    server: Server = ADDRESS,
    participant: Annotated[
        Who, typer.Option(help="You (`person`), or how a simulated participant chooses rooms.")
    ] = Who.SUGGESTION,
    templates: Templates = None,
    seed: Seed = None,
    as_json: AsJson = False,
) -> None:
    """Run a participant (TabUI) at a text server until the game is over."""
    host, port = _address(server)
    default = Study()
    with _bad_input():
        read = read_template_set(shipped().find("templates", templates or default.templates, Path()))
    seat = _seat(participant, read, default.seed if seed is None else seed)
    program = programs.tabui(seat.tabui, host, port, _token(), _lost, _nothing)
    last = _run(_with_keyboard(program, seat.typed))
    if last is None:
        _fail(FAILED, "stopped before the game was over")
    if as_json:
        visited = sum(room.state == "visited" for room in last.rooms)
        _print_json({"score": last.score, "rooms_visited": visited, "over": last.over})
    else:
        out.print(f"The game is over. Score {last.score}.")


@app.command()
def suggest(
    costs: Annotated[Path, typer.Option(help="Cost file in the mapTimes format.")],
    at: Annotated[int, typer.Option(help="Where the robot stands; 0 is the corridor.", min=0)],
    unvisited: Annotated[str, typer.Option(help="Rooms still to visit, e.g. `1,2,5`.")],
    as_json: AsJson = False,
) -> None:
    """Suggest the next room: the first of the cheapest tour of all rooms still to visit."""
    with _bad_input():
        matrix = read_map_times(costs)
    places = [_room(text, matrix.knows) for text in unvisited.split(",")]
    start = _room(str(at), matrix.knows)
    tour = best_tour(matrix, start, places)
    if isinstance(tour, Refused):
        _fail(FAILED, tour.sentence)
    rooms = [room.people for room in tour.rooms]
    cost = int(tour.cost) if tour.cost == int(tour.cost) else tour.cost
    if as_json:
        _print_json({"next": rooms[0], "tour": rooms, "cost": cost})
    else:
        out.print(f"Next room {rooms[0]}; the cheapest tour is {' '.join(map(str, rooms))} and costs {cost}.")


@app.command()
def report(
    bag: Annotated[Path, typer.Argument(help="A ROS 1 bag.")],
    to: Annotated[Path | None, typer.Option("--to", help="The page; by default beside the bag.")] = None,
) -> None:
    """Make a report of a bag: one HTML page with paths, errors, energy, events and talk."""
    with _bad_input():
        _write_report(bag, to or bag.with_suffix(".html"))


@bag_app.command("info")
def bag_info_command(bag: Annotated[Path, typer.Argument(help="A ROS 1 bag.")], as_json: AsJson = False) -> None:
    """Say what is in a bag."""
    with _bad_input():
        found = bag_info(bag)
    if as_json:
        _print_json(msgspec.to_builtins(found, enc_hook=str))
        return
    table = Table("topic", "type", "messages", title=f"{bag}: {found.duration:.1f} s, {found.messages} messages")
    for topic in found.topics:
        table.add_row(topic.name, topic.msgtype, str(topic.messages))
    out.print(table)


@bag_app.command("reindex")
def bag_reindex_command(
    bag: Annotated[Path, typer.Argument(help="A bag whose writer was killed.")], as_json: AsJson = False
) -> None:
    """Recover a bag that was cut off; the original is kept beside it."""
    with _bad_input():
        done = reindex_bag(bag)
    if as_json:
        _print_json(msgspec.to_builtins(done, enc_hook=str))
        return
    out.print(f"Recovered {done.messages} messages into {done.path}; the original is {done.backup}.", highlight=False)
    if done.lost_bytes:
        out.print(f"{done.lost_bytes} bytes at its end were half written and are lost.", highlight=False)


@maps_app.command("check")
def maps_check(
    name: Annotated[str, typer.Argument(help="Name of a map, or the path of its folder.")], as_json: AsJson = False
) -> None:
    """Check a map: image, rooms, goals and start poses."""
    wanted = f"./{name}" if "/" not in name and Path(name).is_dir() else name
    with _bad_input():
        findings = check_map(shipped().find("maps", wanted, Path()))
    errors = sum(finding.severity == "error" for finding in findings)
    if as_json:
        told = [{"severity": finding.severity, "message": str(finding.fault)} for finding in findings]
        _print_json({"ok": errors == 0, "findings": told})
    else:
        for finding in findings:
            out.print(f"{finding.severity}: {finding.fault}", highlight=False, markup=False, soft_wrap=True)
        out.print(f"{errors} errors, {len(findings) - errors} warnings")
    if errors:
        raise typer.Exit(BAD_INPUT)


@maps_app.command("list")
def maps_list() -> None:
    """Name the maps that come with the project."""
    for name in shipped().names("maps"):
        out.print(name)


@ros_app.command("messages")
def ros_messages(folder: Annotated[Path, typer.Argument(help="Where the package goes, e.g. a catkin `src`.")]) -> None:
    """Write our message types as the ROS package `thbridge_msgs`."""
    with _bad_input():
        package = write_package(folder)
    err.print(f"Wrote {package}.", highlight=False)


@study_app.command("init")
def study_init(file: Annotated[Path, typer.Argument(help="The file to write; must not exist.")]) -> None:
    """Write a study file with every key at its default, commented."""
    try:
        with file.open("x", encoding="utf-8") as opened:
            opened.write(commented_study())
    except FileExistsError:
        _fail(BAD_INPUT, f"{file}: there is such a file already. Choose another name.")
    except OSError as error:
        _fail(BAD_INPUT, f"{file}: it cannot be written ({error.strerror}). Choose another folder.")
    err.print(f"Wrote {file}. Run it with `thbridge play {file}`.", highlight=False)


@study_app.command("check")
def study_check(file: Annotated[Path, typer.Argument(help="A study file.")]) -> None:
    """Check a study file and everything it names."""
    _setting(_study(file, {}), file)
    out.print(f"{file}: no faults", highlight=False)


def main() -> None:
    """Run the command line."""
    logging.basicConfig(
        level=logging.WARNING,
        format="%(message)s",
        handlers=[RichHandler(console=err, show_time=False, show_path=False, show_level=False)],
    )
    app()


# What the commands share


def _study(file: Path | None, changes: Mapping[str, object]) -> Study:
    with _bad_input():
        study = Study() if file is None else read_study(file)
    given = {key: value for key, value in changes.items() if value is not None}
    return dataclasses.replace(study, **given)  # type: ignore[arg-type]  # the options have their types from typer


def _setting(study: Study, file: Path | None) -> Setting:
    with _bad_input():
        return read_setting(study, Path() if file is None else file.parent)


def _announce_compiling() -> None:
    if not is_compiled():
        err.print("Compiling the simulator for this machine; only the first start takes this long, some 20 s.")


def _prepare(bag: Path) -> None:
    try:
        bag.parent.mkdir(parents=True, exist_ok=True)
        moved = programs.make_room(bag)
    except OSError as error:
        _fail(BAD_INPUT, f"{bag}: cannot record there ({error.strerror}). Choose another file by --bag.")
    if moved is not None:
        err.print(f"The older recording is now {moved}.", highlight=False)


def _write_report(bag: Path, page: Path) -> None:
    # Half a second of imports that no other command needs.
    from thbridge.study.report_page import build_report  # noqa: PLC0415

    with _bad_input():
        html = build_report(bag)
    try:
        page.write_text(html, encoding="utf-8")
    except OSError as error:
        _fail(BAD_INPUT, f"{page}: it cannot be written ({error.strerror}). Choose another file by --to.")
    err.print(f"Report: {page}", highlight=False)


@dataclasses.dataclass(frozen=True, slots=True)
class _Seat:
    """Whoever plays.

    Attributes:
        tabui: the role.
        typed: takes in a line of the keyboard; None for a simulated participant.
    """

    tabui: TabUI
    typed: Callable[[str], None] | None


def _seat(who: Who, templates: TemplateSet, seed: int) -> _Seat:
    if who is not Who.PERSON:
        return _Seat(TabUI(build_bot(templates, BotStrategy(who), seed)), None)
    person = Person(lambda line: out.print(line, highlight=False, markup=False), templates.kinds, templates.pictures)
    tabui = TabUI(person)

    def typed(line: str) -> None:
        person.type(line)
        tabui.look_again()

    return _Seat(tabui, typed)


async def _with_keyboard(program: Coroutine[object, object, T], typed: Callable[[str], None] | None) -> T:
    """Run a program; lines are taken in as they are typed, between two ticks."""
    if typed is None:
        return await program
    loop = asyncio.get_running_loop()

    def readable() -> None:
        line = sys.stdin.readline()
        if line:
            typed(line)
        else:
            loop.remove_reader(sys.stdin)

    try:
        loop.add_reader(sys.stdin, readable)
    except OSError:
        program.close()
        _fail(BAD_INPUT, "--participant person needs a terminal or a pipe to read from, not a file")
    return await program


def _roles(names: str) -> frozenset[str]:
    chosen = frozenset(name.strip() for name in names.split(",") if name.strip())
    known = {legacy.TABUI, legacy.HIDER}
    wrong = sorted(chosen - known)
    if wrong:
        _fail(BAD_INPUT, f"--outside: {wrong[0]} is not a role that can be left out here; use TabUI or Hider")
    return chosen


def _room(text: str, known: Callable[[Room], bool]) -> Room:
    if not text.strip().isdecimal() or not known(room := Room(int(text))):
        _fail(BAD_INPUT, f"{text.strip() or 'nothing'} is not a place in this cost file")
    return room


def _address(server: str) -> tuple[str, int]:
    host, colon, port = server.rpartition(":")
    if not colon or not host or not port.isdecimal() or not 0 < int(port) < 65536:
        _fail(BAD_INPUT, f"--server: {server} is not HOST:PORT, such as {ADDRESS}")
    return host, int(port)


def _token() -> str:
    """Marks this run of a program, so that the server knows its own connection from before a network fault."""
    return secrets.token_hex(8)


def _lost(lost: Lost) -> None:
    err.print(programs.reason_of(lost), highlight=False)


def _nothing(view: View) -> None:
    """Show nothing until the game is over."""


def _run(program: Coroutine[object, object, T]) -> T:
    try:
        with _bad_input(FAILED):
            return asyncio.run(program)
    except Interrupted:
        _fail(FAILED, "stopped; what was recorded up to here is complete")


@contextmanager
def _bad_input(code: int = BAD_INPUT) -> Iterator[None]:
    """Tell of a file at fault in its own words."""
    try:
        yield
    except BadFile as fault:
        _fail(code, str(fault))


def _fail(code: int, message: str) -> NoReturn:
    err.print(message, style="red", highlight=False, markup=False, soft_wrap=True)
    raise typer.Exit(code)


def _print_json(value: Mapping[str, object]) -> None:
    print(json.dumps(value))  # noqa: T201 - the one line that --json promises


def _show_outcome(outcome: Outcome) -> None:
    table = Table(title="The hunt", show_header=False)
    table.add_row("score", str(outcome.score))
    table.add_row("rooms visited", str(outcome.rooms_visited))
    table.add_row("treasures named", str(outcome.identified))
    for robot, energy in enumerate(outcome.energy):
        table.add_row(f"energy of robot {robot + 1}", f"{energy:g}")
    table.add_row("simulated time", f"{outcome.sim_seconds:.1f} s in {outcome.wall_seconds:.1f} s")
    table.add_row("collisions", str(outcome.collisions))
    table.add_row("bag", str(outcome.bag))
    out.print(table)
