"""The trips of `thbridge maps measure`."""

from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import partial
from multiprocessing import get_context

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from thbridge.hunt.rooms import Room
from thbridge.offline.measure import MeasurementSetup, TripResult, TripTimes, by_pair, drive, trips
from ui.terminal import err, out


def measure_trips(course: MeasurementSetup, runs: int, jobs: int) -> tuple[TripTimes, ...]:
    """Drive all trips, several at a time; how many changes nothing in the result."""
    waiting = list(trips(course.place, runs))
    columns = TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    with (
        Progress(*columns, console=err, transient=True) as shown,
        # Forking would copy the thread that draws the progress in the middle of what it does.
        ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool,
    ):
        task = shown.add_task(f"Trips on {course.place.name}", total=len(waiting))
        done: list[TripResult] = []
        for ended in as_completed(pool.submit(partial(drive, course), trip) for trip in waiting):
            done.append(ended.result())
            shown.advance(task)
    return by_pair(done)


def times_matrix(times: Sequence[TripTimes], rooms: int) -> list[list[float | None]]:
    """Mean seconds by start and goal; 0 is the corridor."""
    matrix: list[list[float | None]] = [[None] * (rooms + 1) for _ in range(rooms + 1)]
    for pair in times:
        matrix[pair.start.people][pair.goal.people] = pair.mean
    return matrix


def times_as_json(pair: TripTimes) -> dict[str, object]:
    """The times of a pair as the JSON object has them."""
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
    """A place as people call it."""
    return "the corridor" if place.is_corridor else f"room {place.people}"
