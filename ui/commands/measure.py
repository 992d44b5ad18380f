"""`thbridge maps measure`: what every trip on a map takes."""

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated, TextIO

import typer
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table

from thbridge.files.template_files import map_times
from thbridge.hunt.rooms import Room
from thbridge.offline.measure import MeasurementSetup, TripResult, TripTimes, by_pair, drive, trips
from ui.options import AsJson, announce_compiling, setting_of, study_of
from ui.terminal import BAD_INPUT, FAILED, err, fail, note, out, print_json


def maps_measure(
    name: Annotated[str, typer.Argument(help="Name of a map, or the path of its folder.")],
    runs: Annotated[int, typer.Option(help="Trips from each place to each room; their mean counts.", min=1)] = 3,
    to: Annotated[
        Path | None, typer.Option("--out", help="The mapTimes file to write; must not exist. Without it, only shown.")
    ] = None,
    study_file: Annotated[
        Path | None, typer.Option("--study", help="Study file; its `world` and `robot` drive.")
    ] = None,
    seed: Annotated[int | None, typer.Option(help="Of all chance in the trips.", min=0, max=2**31 - 1)] = None,
    jobs: Annotated[
        int | None, typer.Option(help="Trips driven at a time; by default one on every core.", min=1, max=256)
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Measure a map: drive a robot from every place to every room; the mean seconds make a mapTimes file."""
    place_name = str(Path(name).resolve()) if "/" in name or Path(name).is_dir() else name
    setting = setting_of(study_of(study_file, {"map": place_name, "robots": 1, "seed": seed}), study_file)
    study, place = setting.study, setting.map
    course = MeasurementSetup(place, study.world, study.robot, study.seed)
    announce_compiling()
    with _file(to) as write:
        times = _measured(course, runs, jobs or os.cpu_count() or 1)
        write(map_times(_matrix(times, len(place.rooms))))
    for pair in times:
        for refusal in pair.refusals:
            note(f"{_spoken(pair.start)} to {_spoken(pair.goal)}: not reached: {refusal}")
    if as_json:
        told = None if to is None else str(to)
        print_json({"map": place.name, "runs": runs, "file": told, "trips": [_entry(pair) for pair in times]})
    else:
        _show(times, f"{place.name}: mean seconds of {runs} trips each")
    if to is not None:
        note(f"Wrote {to}. Put it into the map's folder as mapTimes, or name it by `game: costs:` in a study.")
    if any(pair.mean is None for pair in times):
        raise typer.Exit(FAILED)


@contextmanager
def _file(path: Path | None) -> Iterator[Callable[[str], None]]:
    """See that the file can be written before hours of driving, and leave no empty one behind when they are cut off."""
    if path is None:
        yield lambda text: None
        return
    try:
        file = path.open("x", encoding="ascii")
    except FileExistsError:
        fail(BAD_INPUT, f"--out: there is a file {path} already. Choose another name.")
    except OSError as error:
        fail(BAD_INPUT, f"--out: {path} cannot be written ({error.strerror}). Choose another file.")
    with file:
        try:
            yield lambda text: _write(file, text)
        finally:
            if path.stat().st_size == 0:
                path.unlink()


def _write(file: TextIO, text: str) -> None:
    file.write(text)
    file.flush()


def _measured(course: MeasurementSetup, runs: int, jobs: int) -> tuple[TripTimes, ...]:
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


def _matrix(times: Sequence[TripTimes], rooms: int) -> list[list[float | None]]:
    matrix: list[list[float | None]] = [[None] * (rooms + 1) for _ in range(rooms + 1)]
    for pair in times:
        matrix[pair.start.people][pair.goal.people] = pair.mean
    return matrix


def _entry(pair: TripTimes) -> dict[str, object]:
    return {
        "from": pair.start.people,
        "to": pair.goal.people,
        "mean": pair.mean,
        "deviation": pair.deviation,
        "seconds": list(pair.seconds),
        "refusals": list(pair.refusals),
    }


def _show(times: Sequence[TripTimes], title: str) -> None:
    rooms = max(pair.goal.people for pair in times)
    table = Table("from", *(f"to {goal}" for goal in range(1, rooms + 1)), title=title)
    matrix = _matrix(times, rooms)
    for start, row in enumerate(matrix):
        cells = ["-" if mean is None else f"{mean:.1f}" for mean in row[1:]]
        table.add_row("corridor" if start == 0 else str(start), *cells)
    out.print(table)


def _spoken(place: Room) -> str:
    return "the corridor" if place.is_corridor else f"room {place.people}"
