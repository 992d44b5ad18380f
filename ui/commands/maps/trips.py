"""Trips of `thbridge maps measure`."""

import signal
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from multiprocessing import get_context
from pathlib import Path

from rich.table import Table

from thbridge.app.compose.machine import versions
from thbridge.files.disk.whole import write_whole
from thbridge.files.progress import Tell
from thbridge.hunt.rooms import Room
from thbridge.offline.kept_trips import KeptTrips, digest_of, kept_path
from thbridge.offline.measure import MeasurementSetup, RoomTrip, TripResult, TripTimes, by_pair, drive, trips
from thbridge.study.plugins import part_keys
from ui.command_line.terminal import FAILED, fail, note, out


def measure_trips(
    course: MeasurementSetup,
    runs: int,
    jobs: int,
    result: Path | None,
    tell: Tell,
    again: str = "the same command",
) -> tuple[TripTimes, ...]:
    """Drive all trips, several at the same time; the number of simultaneous trips does not change the result.

    Args:
        course: map and robot.
        runs: trips per pair of places.
        jobs: number of trips driven at the same time.
        result: file for the times. Finished trips are stored next to it, and a later run drives only missing trips.
            If None, no trips are stored.
        `tell`: function that receives the progress.
        again: command that continues a stopped measurement.

    Raises:
        BadFile: the trips cannot be saved.
    """
    wanted = list(trips(course.place, runs))
    if result is None:
        return by_pair(_driven(course, wanted, {}, None, jobs, tell).values())
    with KeptTrips(result, digest_of(course, versions(part_keys(course.robot)))) as kept:
        if kept.dropped:
            note(f"{kept.path} contains trips on another map or with other settings. Measuring from the beginning.")
        done = {trip: kept.done[trip] for trip in wanted if trip in kept.done}
        if done:
            note(
                f"{len(done)} of {len(wanted)} trips are known from an earlier run ({kept.path}). Measuring the others."
            )
        try:
            return by_pair(_driven(course, wanted, done, kept, jobs, tell).values())
        except KeyboardInterrupt:
            fail(FAILED, f"Stopped. {len(kept.done)} trips are kept in {kept.path}; continue with {again}.")


def _driven(
    course: MeasurementSetup,
    wanted: Sequence[RoomTrip],
    done: dict[RoomTrip, TripResult],
    kept: KeptTrips | None,
    jobs: int,
    tell: Tell,
) -> dict[RoomTrip, TripResult]:
    """Drive the missing trips, and return the results of all trips."""
    left = [trip for trip in wanted if trip not in done]
    tell("trips", len(done), len(wanted))
    # Processes are spawned, because a fork would copy the thread that shows progress in the middle of its work.
    pool = ProcessPoolExecutor(jobs, get_context("spawn"), signal.signal, (signal.SIGINT, signal.SIG_IGN))
    try:
        for ended in as_completed(pool.submit(partial(drive, course), trip) for trip in left):
            driven = ended.result()
            done[driven.trip] = driven
            if kept is not None:
                kept.add(driven)
            tell("trips", len(done), len(wanted))
    finally:
        pool.shutdown(cancel_futures=True)
    return done


def write_times(result: Path, text: str) -> None:
    """Write the result, then remove the trips stored next to it. Raise BadFile if the file cannot be written."""
    write_whole(result, text.encode("ascii"), "choose another file with --out")
    kept_path(result).unlink(missing_ok=True)


def times_matrix(times: Sequence[TripTimes], rooms: int) -> list[list[float | None]]:
    """Return the mean seconds by start and goal; place 0 is the corridor."""
    matrix: list[list[float | None]] = [[None] * (rooms + 1) for _ in range(rooms + 1)]
    for pair in times:
        matrix[pair.start.people][pair.goal.people] = pair.mean
    return matrix


def times_as_json(pair: TripTimes) -> dict[str, object]:
    """Return the times of a pair as a JSON object."""
    return {
        "from": pair.start.people,
        "to": pair.goal.people,
        "mean": pair.mean,
        "deviation": pair.deviation,
        "seconds": list(pair.seconds),
        "refusals": list(pair.refusals),
    }


def show_times(times: Sequence[TripTimes], title: str) -> None:
    """Print a table of mean seconds."""
    rooms = max(pair.goal.people for pair in times)
    table = Table("from", *(f"to {goal}" for goal in range(1, rooms + 1)), title=title)
    matrix = times_matrix(times, rooms)
    for start, row in enumerate(matrix):
        cells = ["-" if mean is None else f"{mean:.1f}" for mean in row[1:]]
        table.add_row("corridor" if start == 0 else str(start), *cells)
    out.print(table)


def spoken_place(place: Room) -> str:
    """Return the name of a place for messages."""
    return "the corridor" if place.is_corridor else f"room {place.people}"
