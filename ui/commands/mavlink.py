"""The commands about MAVLink: who is there, and go there, as a ground station; and a recording's frames again."""

import asyncio
import dataclasses
import math
from collections.abc import AsyncIterator, Coroutine
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Annotated, NoReturn, TypeVar

import typer
from rich.table import Table

from thbridge.app.compose import StudySetting, read_setting
from thbridge.app.replay.mavlink_replay import FramesOptions, FramesReplayed, HuntResult, has_session, replay_frames
from thbridge.app.replay.replay import session_of
from thbridge.app.session.session import TickRecord
from thbridge.files.signing_key import read_signing_key
from thbridge.sockets.addresses import Address, parse_address
from thbridge.sockets.mavlink.client import StationSocket, Unreachable, open_station
from thbridge.study.overrides import with_changes
from thbridge.study.study_file import read_study_text
from thbridge.timing.loop import stopping
from thbridge.wire.mavlink import conventions
from thbridge.wire.mavlink.frames.signing import SigningKey
from thbridge.wire.mavlink.modes import shown_mode_name
from thbridge.wire.mavlink.station.ground_station import KnownRobot
from thbridge.wire.mavlink.station.trip import Destination, StationTrip, StationTripStage, TripOutcome
from ui.commands.replay import changes_of, other_versions
from ui.options import AsJson, KeyFile, announce_compiling, make_copy_ready, setting_of, study_of
from ui.story import print_story
from ui.terminal import BAD_INPUT, FAILED, bad_input, fail, note, out, print_json

T = TypeVar("T")

USUAL = "127.0.0.1:14550"
OTHER = "127.0.0.1:14540"
_TCP = "tcp:"
_TELL_SECONDS = 2.0
"""Seconds between two lines of progress while a robot drives."""

mavlink_app = typer.Typer(
    help="MAVLink: watch and command robots that speak it, such as those of `thbridge play --mavlink`.",
    no_args_is_help=True,
)

Where = Annotated[
    str,
    typer.Argument(
        metavar="HOST:PORT", help="An address that robots speak to by UDP, or tcp:HOST:PORT where they can be reached."
    ),
]


@mavlink_app.command("status")
def mavlink_status(
    where: Where = USUAL,
    seconds: Annotated[float, typer.Option(help="How long to listen.", min=0.1, max=3600)] = 3.0,
    signing_key: KeyFile = None,
    as_json: AsJson = False,
) -> None:
    """Tell which robots are there, and how they stand."""
    address, tcp = _address(where, "HOST:PORT")

    async def listen() -> StationSocket:
        async with _station(address, tcp, _key(signing_key)) as link:
            loop = asyncio.get_running_loop()
            until = loop.time() + seconds
            while loop.time() < until:
                await link.poll()
            return link

    link = _run(listen())
    if not link.station.robots:
        _nobody(link, address, signing_key)
    robots = [link.station.robots[system] for system in sorted(link.station.robots)]
    if as_json:
        print_json({"robots": [_figures(robot) for robot in robots]})
    else:
        out.print(_table(robots))
        for robot in robots:
            if robot.text:
                out.print(f"robot {robot.system}: {robot.text}", highlight=False, markup=False)


@mavlink_app.command("goto", context_settings={"ignore_unknown_options": True})
def mavlink_goto(
    robot: Annotated[int, typer.Argument(help="The robot's number, which is its system id.", min=1, max=255)],
    x: Annotated[float, typer.Argument(help="Metres east of the map's origin.")],
    y: Annotated[float, typer.Argument(help="Metres north of it.")],
    at: Annotated[str, typer.Option("--at", metavar="HOST:PORT", help="Where it speaks; as for `status`.")] = USUAL,
    heading: Annotated[
        float | None, typer.Option(help="Which way it is to look there: degrees from east, anticlockwise.")
    ] = None,
    keep: Annotated[bool, typer.Option("--keep", help="Stay in command of it afterwards.")] = False,
    signing_key: KeyFile = None,
) -> None:
    """Take command of a robot, send it to a point of the map, wait until it is there, and give it back.

    Its number, X and Y are those of `thbridge mavlink status`. A point in a room is a move of the game.
    """
    for name, value in (("X", x), ("Y", y), ("--heading", 0.0 if heading is None else heading)):
        if not abs(value) < 1e5:
            fail(BAD_INPUT, f"{name}: {value:g} is not within 100,000. Give metres, and degrees for --heading.")
    address, tcp = _address(at, "--at")
    destination = Destination(x, y, None if heading is None else math.radians(heading))

    async def drive() -> tuple[StationSocket, TripOutcome]:
        async with _station(address, tcp, _key(signing_key)) as link:
            return link, await _drive(link, robot, destination, keep)

    link, outcome = _run(drive())
    if not link.station.robots:
        _nobody(link, address, signing_key)
    if outcome.problem:
        hint = " If it wants signatures, give --signing-key." if signing_key is None and outcome.unanswered else ""
        fail(FAILED, f"{outcome.problem[:1].upper()}{outcome.problem[1:].rstrip('.')}.{hint}")
    there = link.station.robots[robot]
    out.print(f"Robot {robot} is at {there.x:.2f} {there.y:.2f}.", highlight=False)


@mavlink_app.command("replay")
def mavlink_replay(
    bag: Annotated[Path, typer.Argument(help="A recording with topics /robotN/mavlink/to.")],
    study_file: Annotated[
        Path | None, typer.Option("--study", help="Study to run it in; by default the recording's own.")
    ] = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--with",
            metavar="KEY=VALUE|FILE.yaml",
            help="Change this in the recording's study, e.g. `--with seed=2`. May be given several times.",
        ),
    ] = None,
    rate: Annotated[
        float | None, typer.Option(help="Simulated seconds per second; full speed by default.", min=0.01)
    ] = None,
    to: Annotated[Path | None, typer.Option(help="Keep the new recording in this bag.")] = None,
    longer: Annotated[float, typer.Option(help="Seconds to go on after the end of the recording.", min=0)] = 0.0,
    beside: Annotated[Path, typer.Option(help="Folder that paths in the recording's study start from.")] = Path(),
    as_json: AsJson = False,
) -> None:
    """Drive a fresh hunt by a recording's MAVLink frames alone: each robot hears again what it was told.

    Ends with 1 where rooms were not reached in the recorded order, or the score is another, and nothing was changed.
    """
    what_if = study_file is not None or bool(changes)
    setting = _setting(bag, study_file, changes or [], beside)
    if to is not None:
        make_copy_ready(to, bag)

    def progress(moment: TickRecord) -> None:
        if not as_json:
            print_story(moment)

    announce_compiling()
    with bad_input():
        done = asyncio.run(replay_frames(bag, setting, FramesOptions(rate or 0.0, to, longer), progress))
    if as_json:
        print_json(dataclasses.asdict(done) | {"same": done.same, "bag": None if to is None else str(to)})
    else:
        _show(done)
    if not done.finished:
        fail(FAILED, "stopped before the end of the recording")
    if done.recorded is not None and not done.same and not what_if:
        raise typer.Exit(FAILED)


def _setting(bag: Path, study_file: Path | None, changes: list[str], beside: Path) -> StudySetting:
    """The study of a recording, or another one."""
    if study_file is not None:
        if changes:
            fail(BAD_INPUT, "--with: it changes the recording's study; --study gives another. Leave one of them out.")
        return setting_of(study_of(study_file, {}), study_file)
    with bad_input():
        if not has_session(bag):
            fail(BAD_INPUT, f"{bag}: it does not say what it was recorded with. Give a study by --study.")
        record = session_of(bag)
        for sentence in other_versions(record):
            note(sentence)
        return read_setting(with_changes(read_study_text(bag, record.study), *changes_of(changes)), beside)


def _show(done: FramesReplayed) -> None:
    table = Table("", "recorded", "replayed", title=f"{done.frames} frames in {done.wall_seconds:.1f} s")
    was, now = done.recorded, done.replayed
    table.add_row("score", "-" if was is None else str(was.score), str(now.score))
    table.add_row("rooms reached", "-" if was is None else _arrivals(was), _arrivals(now))
    out.print(table)
    if done.unusable:
        note(f"{done.unusable} messages held no frame, or were for robots that there are not.")
    if done.compared and done.parted is None:
        out.print("Every robot drove as it was recorded, to the last bit.", highlight=False)
    elif done.parted is not None:
        out.print(f"A robot first was elsewhere than recorded at {done.parted:.2f} s.", highlight=False)


def _arrivals(hunt: HuntResult) -> str:
    """The rooms in order, each with the robot that reached it."""
    return ", ".join(f"{arrival.room} (robot {arrival.robot})" for arrival in hunt.arrivals) or "none"


async def _drive(link: StationSocket, robot: int, destination: Destination, keep: bool) -> TripOutcome:
    clock = asyncio.get_running_loop().time
    trip = StationTrip(link.station, robot, destination, keep, clock())
    stage, told = trip.stage, clock()
    with stopping() as stopped:
        while trip.outcome is None:
            trip.advance(await link.poll(), clock())
            if stopped.is_set() and trip.stage not in (StationTripStage.RETURNING, StationTripStage.OVER):
                trip.give_up(clock())
            if trip.stage is not stage and trip.stage is StationTripStage.UNDER_WAY:
                note(f"Robot {robot} is on its way.")
                told = clock()
            if trip.stage is StationTripStage.UNDER_WAY and clock() - told >= _TELL_SECONDS:
                told = clock()
                note(f"{trip.remaining:.1f} m to go")
            stage = trip.stage
    return trip.outcome


def _figures(robot: KnownRobot) -> dict[str, object]:
    """A robot as the JSON object has it; null for values that it has not sent."""
    seconds = max(robot.last_frame - robot.first_heartbeat, 1e-9)
    return {
        "robot": robot.system,
        "mode": shown_mode_name(robot.autopilot, robot.custom_mode),
        "armed": robot.armed,
        "commander": _commander(robot),
        "x": _known(robot.x, 3),
        "y": _known(robot.y, 3),
        "latitude": _known(robot.latitude, 7),
        "longitude": _known(robot.longitude, 7),
        "energy": _known(robot.energy, 2),
        "frames": robot.frames,
        "frames_per_second": round((robot.frames - 1) / seconds, 1) if robot.frames > 1 else 0.0,
        "lost": robot.lost,
        "text": robot.text,
    }


def _commander(robot: KnownRobot) -> str | None:
    match robot.commander:
        case None:
            return None
        case conventions.BY_PARTICIPANT:
            return "participant"
        case conventions.BY_OTHERS:
            return "researcher"
        case system:
            return f"ground station {system}"


def _known(value: float, digits: int) -> float | None:
    return None if math.isnan(value) else round(value, digits)


def _table(robots: list[KnownRobot]) -> Table:
    table = Table("robot", "mode", "armed", "commander", "x, y (m)", "energy", "frames/s", "lost")
    for robot in robots:
        figures = _figures(robot)
        place = "" if math.isnan(robot.x) else f"{robot.x:.2f}, {robot.y:.2f}"
        energy = "" if math.isnan(robot.energy) else f"{robot.energy:.0%}"
        rate, armed = str(figures["frames_per_second"]), "yes" if robot.armed else "no"
        mode, commander = str(figures["mode"]), _commander(robot) or ""
        table.add_row(str(robot.system), mode, armed, commander, place, energy, rate, str(robot.lost))
    return table


# Where robots are spoken to


def _address(text: str, option: str) -> tuple[Address, bool]:
    """An address, and True if it is of TCP."""
    bare = text.removeprefix(_TCP)
    address = parse_address(bare.removeprefix("udp:"))
    if address is None:
        fail(BAD_INPUT, f"{option}: {text!r} is no address. Write HOST:PORT, such as {USUAL}, or tcp:HOST:PORT.")
    return address, bare != text


def _key(path: Path | None) -> SigningKey | None:
    with bad_input():
        return None if path is None else read_signing_key(path)


def _run(program: Coroutine[object, object, T]) -> T:
    try:
        return asyncio.run(program)
    except KeyboardInterrupt:
        fail(FAILED, "stopped")


@asynccontextmanager
async def _station(address: Address, tcp: bool, key: SigningKey | None) -> AsyncIterator[StationSocket]:
    try:
        async with open_station(address, tcp, key) as link:
            yield link
    except Unreachable as why:
        remedy = "Start robots there, by `thbridge play --mavlink --tcp HOST:PORT`" if tcp else "Give another address"
        fail(FAILED, f"{address}: {why}. {remedy}.")


def _nobody(link: StationSocket, address: Address, key: Path | None) -> NoReturn:
    """End the command, with reasons why no robot may have answered."""
    if link.refused:
        fail(FAILED, f"{address}: {link.refused} frames were refused, for they are not signed with the key of {key}.")
    if link.is_listening:
        remedy = "Start `thbridge play --mavlink`, or give the address that it tells"
        fail(FAILED, f"{address}: nobody speaks MAVLink there. {remedy}.")
    remedy = f"Give an address that is free, such as {OTHER}; robots speak to several, see `play --udp`"
    fail(FAILED, f"{address}: another program has this address, or another machine, and no robot answers. {remedy}.")
