"""Commands of `thbridge mavlink`: list robots, send a robot to a point, and replay the frames of a recording."""

import dataclasses
import math
from pathlib import Path
from typing import Annotated

import typer

from thbridge.sockets.addresses import Address, parse_address
from ui.command_line.options import AsJson, KeyFile, StudyOption, the_study
from ui.command_line.outputs import make_copy_ready
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail, out, print_json, show

USUAL = "127.0.0.1:14550"

mavlink_goto = typer.Typer(add_completion=False)


_TCP = "tcp:"

Where = Annotated[
    str,
    typer.Argument(
        metavar="HOST:PORT", help="UDP address to which robots send; tcp:HOST:PORT connects to robots by TCP."
    ),
]


def mavlink_status(
    where: Where = USUAL,
    seconds: Annotated[float, typer.Option(help="Time to listen, in seconds.", min=0.1, max=3600)] = 3.0,
    signing_key: KeyFile = None,
    as_json: AsJson = False,
) -> None:
    """List the robots that send MAVLink, with their states."""
    import asyncio

    from thbridge.mavlink.sockets.client import StationSocket
    from ui.commands.mavlink.station import (
        fail_without_robots,
        run_program,
        sighting_as_json,
        sightings_table,
        station_at,
    )

    address, tcp = _address(where, "HOST:PORT")

    async def listen() -> StationSocket:
        async with station_at(address, tcp, signing_key) as link:
            loop = asyncio.get_running_loop()
            until = loop.time() + seconds
            while loop.time() < until:
                await link.poll()
            return link

    link = run_program(listen())
    if not link.station.robots:
        fail_without_robots(link, address, signing_key)
    robots = [link.station.robots[system] for system in sorted(link.station.robots)]
    if as_json:
        print_json({"robots": [sighting_as_json(robot) for robot in robots]})
    else:
        out.print(sightings_table(robots))
        for robot in robots:
            if robot.text:
                show(f"robot {robot.system}: {robot.text}")


@mavlink_goto.command(context_settings={"ignore_unknown_options": True})
def goto(
    robot: Annotated[int, typer.Argument(help="Number of the robot (its system id).", min=1, max=255)],
    x: Annotated[float, typer.Argument(help="Meters east of the map's origin.")],
    y: Annotated[float, typer.Argument(help="Meters north of the map's origin.")],
    at: Annotated[str, typer.Option(metavar="HOST:PORT", help="Address, as for `mavlink status`.")] = USUAL,
    heading: Annotated[
        float | None, typer.Option(help="Heading at the goal: degrees counterclockwise from east.")
    ] = None,
    keep: Annotated[
        bool, typer.Option("--keep", help="Keep control of the robot at the end, instead of giving it back.")
    ] = False,
    signing_key: KeyFile = None,
) -> None:
    """Take command of a robot, send it to a point of the map, wait until it arrives, and release command.

    `thbridge mavlink status` prints the robot's number and its x and y. If the point is in a room, the drive is a move
    of the game.
    """
    from thbridge.mavlink.sockets.client import StationSocket
    from thbridge.mavlink.station.trip import TripOutcome
    from thbridge.mavlink.values.vehicle_interface import Target
    from ui.commands.mavlink.station import drive_robot, fail_without_robots, run_program, station_at

    for name, value in (("X", x), ("Y", y), ("--heading", 0.0 if heading is None else heading)):
        if not abs(value) < 1e5:
            fail(
                BAD_INPUT,
                f"{name}: {value:g} is not within -100,000 to 100,000. Write meters, and degrees for --heading.",
            )
    address, tcp = _address(at, "--at")
    destination = Target(x, y, None if heading is None else math.radians(heading))

    async def drive() -> tuple[StationSocket, TripOutcome]:
        async with station_at(address, tcp, signing_key) as link:
            return link, await drive_robot(link, robot, destination, keep)

    link, outcome = run_program(drive())
    if not link.station.robots:
        fail_without_robots(link, address, signing_key)
    if outcome.problem:
        hint = ""
        if signing_key is None and outcome.unanswered:
            hint = " If the robot requires signed frames, add --signing-key."
        fail(FAILED, f"{outcome.problem[:1].upper()}{outcome.problem[1:].rstrip('.')}.{hint}")
    there = link.station.robots[robot]
    show(f"Robot {robot} is at x {there.x:.2f} m, y {there.y:.2f} m.")


def mavlink_replay(
    bag: Annotated[Path, typer.Argument(help="Recording with topics /robotN/mavlink/to.")],
    study_file: Annotated[
        Path | None, typer.Argument(help="Study file to run; default: the study in the recording.")
    ] = None,
    study_option: StudyOption = None,
    changes: Annotated[
        list[str] | None,
        typer.Option(
            "--with",
            metavar="KEY=VALUE|FILE.yaml",
            help="Change a key of the recorded study, for example `--with seed=2`, or all keys that a FILE.yaml "
            "contains. Can be repeated.",
        ),
    ] = None,
    rate: Annotated[
        float | None, typer.Option(help="Simulated seconds per real second; default: full speed.", min=0.01, max=1000)
    ] = None,
    to: Annotated[Path | None, typer.Option(help="Bag to write the new recording to.")] = None,
    longer: Annotated[float, typer.Option(help="Seconds to continue after the end of the recording.", min=0)] = 0.0,
    beside: Annotated[
        Path, typer.Option(help="Folder from which relative paths in the recorded study start.")
    ] = Path(),
    as_json: AsJson = False,
) -> None:
    """Run a new hunt in which robots receive only the MAVLink frames of a recording.

    The exit code is 1 if the rooms were reached in another order or the score differs, unless a study file or `--with`
    is given.
    """
    import asyncio

    from thbridge.app.replay.mavlink_replay import FramesOptions, replay_frames
    from thbridge.app.session.session import TickRecord
    from ui.command_line.story import print_story
    from ui.commands.mavlink.station import setting_of_recording, show_frames_replayed
    from ui.first_start.compiling import compile_ahead

    study_file = the_study(study_file, study_option)
    what_if = study_file is not None or bool(changes)
    setting = setting_of_recording(bag, study_file, changes or [], beside)
    if to is not None:
        make_copy_ready(to, bag, setting.study.recording.compression)

    rooms = setting.map.room_names

    def progress(moment: TickRecord) -> None:
        if not as_json:
            print_story(moment, rooms)

    compile_ahead(whole_hunt=False)
    with bad_input():
        done = asyncio.run(replay_frames(bag, setting, FramesOptions(rate or 0.0, to, longer), progress))
    if as_json:
        print_json(dataclasses.asdict(done) | {"same": done.same, "bag": None if to is None else str(to)})
    else:
        show_frames_replayed(done)
    if not done.finished:
        fail(FAILED, "Stopped before the end of the recording.")
    if done.recorded is not None and not done.same and not what_if:
        raise typer.Exit(FAILED)


def _address(text: str, option: str) -> tuple[Address, bool]:
    """Return an address, and True if it is a TCP address."""
    bare = text.removeprefix(_TCP)
    address = parse_address(bare.removeprefix("udp:"))
    if address is None:
        fail(BAD_INPUT, f"{option}: {text!r} is not an address. Write HOST:PORT, such as {USUAL}, or tcp:HOST:PORT.")
    return address, bare != text
