"""Small ground station of `thbridge mavlink`, and its output."""

import asyncio
import math
from collections.abc import AsyncIterator, Coroutine
from contextlib import asynccontextmanager
from pathlib import Path
from typing import NoReturn, TypeVar

from rich.table import Table

from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.replay.mavlink_replay import FramesReplayed, HuntResult, has_session
from thbridge.app.replay.replay import recorded_study, session_of
from thbridge.mavlink.files.signing_key import read_signing_key
from thbridge.mavlink.files.signing_timestamps import TimestampFile
from thbridge.mavlink.sockets.client import StationSocket, Unreachable, open_station
from thbridge.mavlink.station.ground_station import KnownRobot
from thbridge.mavlink.station.trip import StationTrip, StationTripStage, TripOutcome
from thbridge.mavlink.values import conventions
from thbridge.mavlink.values.vehicle_interface import Target
from thbridge.mavlink.wire.frames.signing import SigningKey
from thbridge.mavlink.wire.mode_numbers import shown_mode_name
from thbridge.sockets.addresses import Address
from thbridge.study.overrides import with_changes
from thbridge.timing.loop import stopping
from ui.command_line.settings import changes_of, setting_of, study_of
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail, note, out, show
from ui.commands.replay.difference import other_versions

T = TypeVar("T")


OTHER = "127.0.0.1:14540"


_PROGRESS_SECONDS = 2.0
"""Seconds between two lines of progress while a robot drives."""


def setting_of_recording(bag: Path, study_file: Path | None, changes: list[str], beside: Path) -> StudySetting:
    """Return the study in a recording or, if a study file is given, the study in that file."""
    if study_file is not None:
        if changes:
            fail(
                BAD_INPUT,
                "--with: this option changes the study in the recording, but a study file is given. Omit one of them.",
            )
        return setting_of(study_of(study_file, {}), study_file)
    with bad_input():
        if not has_session(bag):
            fail(BAD_INPUT, f"{bag}: the recording does not contain its study. Name a study file after the recording.")
        record = session_of(bag)
        for sentence in other_versions(record):
            note(sentence)
        return read_setting(with_changes(recorded_study(bag, record), *changes_of(changes)), beside)


def show_frames_replayed(done: FramesReplayed) -> None:
    """Print the result of replaying a recording's frames."""
    table = Table("", "recorded", "replayed", title=f"{done.frames} frames in {done.wall_seconds:.1f} s")
    was, now = done.recorded, done.replayed
    table.add_row("score", "-" if was is None else str(was.score), str(now.score))
    table.add_row("rooms reached", "-" if was is None else _arrivals(was), _arrivals(now))
    out.print(table)
    if done.unusable:
        note(f"{done.unusable} messages were ignored: they contained no frame, or were for robots that do not exist.")
    if done.compared and done.parted is None:
        show("Each robot drove exactly as recorded, bit for bit.")
    elif done.parted is not None:
        show(f"First difference: at {done.parted:.2f} s, the pose of a robot was not as recorded.")


def _arrivals(hunt: HuntResult) -> str:
    """Return the rooms in the order they were reached, each with its robot."""
    return ", ".join(f"{arrival.room} (robot {arrival.robot})" for arrival in hunt.arrivals) or "none"


async def drive_robot(link: StationSocket, robot: int, destination: Target, keep: bool) -> TripOutcome:
    """Drive a robot to a place, and print its progress."""
    clock = asyncio.get_running_loop().time
    trip = StationTrip(link.station, robot, destination, keep, clock())
    stage, shown = trip.stage, clock()
    with stopping() as stopped:
        while trip.outcome is None:
            trip.advance(await link.poll(), clock())
            if stopped.is_set() and trip.stage not in (StationTripStage.RETURNING, StationTripStage.OVER):
                trip.give_up(clock())
            if trip.stage is not stage and trip.stage is StationTripStage.UNDER_WAY:
                note(f"Robot {robot} is on its way.")
                shown = clock()
            if trip.stage is StationTripStage.UNDER_WAY and clock() - shown >= _PROGRESS_SECONDS:
                shown = clock()
                note(f"Robot {robot}: {trip.remaining:.1f} m to the goal")
            stage = trip.stage
    return trip.outcome


def sighting_as_json(robot: KnownRobot) -> dict[str, object]:
    """Return a robot as a JSON object; values that the robot has not sent are null."""
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


def sightings_table(robots: list[KnownRobot]) -> Table:
    """Return robots as a table."""
    table = Table("robot", "mode", "armed", "commander", "x, y (m)", "energy", "frames/s", "lost\nframes")
    for robot in robots:
        figures = sighting_as_json(robot)
        place = "" if math.isnan(robot.x) else f"{robot.x:.2f}, {robot.y:.2f}"
        energy = "" if math.isnan(robot.energy) else f"{robot.energy:.0%}"
        rate, armed = str(figures["frames_per_second"]), "yes" if robot.armed else "no"
        mode, commander = str(figures["mode"]), _commander(robot) or ""
        table.add_row(str(robot.system), mode, armed, commander, place, energy, rate, str(robot.lost))
    return table


def _signing_key_in(path: Path | None) -> SigningKey | None:
    """Return the signing key in a file; None without a file."""
    with bad_input():
        return None if path is None else read_signing_key(path)


def run_program(program: Coroutine[object, object, T]) -> T:
    """Run a program; Ctrl-C ends the command."""
    try:
        return asyncio.run(program)
    except KeyboardInterrupt:
        fail(FAILED, "The command was stopped.")


@asynccontextmanager
async def station_at(address: Address, tcp: bool, key: Path | None) -> AsyncIterator[StationSocket]:
    """Open the link of a ground station, signed with the key in a file; end the command if this fails."""
    secret, store = _signing_key_in(key), None if key is None else TimestampFile(key, ".station")
    try:
        async with open_station(address, tcp, secret, store) as link:
            yield link
    except Unreachable as why:
        remedy = "Start robots there with `thbridge play --mavlink --tcp HOST:PORT`" if tcp else "Use another address"
        fail(FAILED, f"{address}: {why}. {remedy}.")


def fail_without_robots(link: StationSocket, address: Address, key: Path | None) -> NoReturn:
    """End the command with a message about the probable reason why no robot has answered."""
    if link.refused:
        fail(
            FAILED, f"{address}: {link.refused} frames were refused, because they are not signed with the key in {key}."
        )
    if link.is_listening:
        remedy = "Start `thbridge play --mavlink`, or use the address that it prints"
        fail(FAILED, f"{address}: no program sends MAVLink there. {remedy}.")
    remedy = f"Use a free address, such as {OTHER}; robots can send to several addresses, see `play --udp`"
    fail(FAILED, f"{address}: this address belongs to another program or machine, and no robot answers. {remedy}.")
