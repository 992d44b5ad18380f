"""`thbridge maps measure`: the duration of each trip on a map."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson, ProgressKind, ProgressOption, StudyOption, the_study
from ui.command_line.outputs import STANDARD_OUTPUT, share_no_output
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail, note, print_json


def maps_measure(
    name: Annotated[str, typer.Argument(help="Name of a map, or the path of its folder.")],
    study_file: Annotated[
        Path | None, typer.Argument(help="Study file; its sections `world` and `robot` are used.")
    ] = None,
    runs: Annotated[
        int, typer.Option(help="Number of trips from each place to each room; the mean time is used.", min=1)
    ] = 3,
    to: Annotated[
        Path | None,
        typer.Option(
            "--out", help="mapTimes file to write; must not exist. `-` is standard output. Default: only print a table."
        ),
    ] = None,
    study_option: StudyOption = None,
    seed: Annotated[int | None, typer.Option(help="Random seed.", min=0, max=2**31 - 1)] = None,
    jobs: Annotated[
        int | None,
        typer.Option(help="Number of trips simulated at the same time; default: one per core.", min=1, max=256),
    ] = None,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Measure a map: drive a robot from each place to each room, and write the mean durations as a mapTimes file.

    You can stop the command and later continue with the same command: it keeps finished trips next to the file.
    """
    from thbridge.app.compose.installed_parts import installed_parts
    from thbridge.files.map_files import read_map
    from thbridge.files.map_times import map_times
    from thbridge.offline.measure import MeasurementSetup
    from ui.command_line.progress import shown_progress
    from ui.command_line.settings import map_folder, study_of
    from ui.commands.maps.trips import (
        measure_trips,
        show_times,
        spoken_place,
        times_as_json,
        times_matrix,
        write_times,
    )
    from ui.first_start.compiling import announce_compiling, usable_cores

    share_no_output(to, as_json)
    folder = map_folder(name)
    study = study_of(the_study(study_file, study_option), {"seed": seed})
    with bad_input():
        place = read_map(folder, study.world.footprint, with_costs=False)
        parts = installed_parts([study.robot])
    course = MeasurementSetup(place, study.world, study.robot, study.seed, parts)
    announce_compiling()
    result = None if to == STANDARD_OUTPUT else to
    if result is not None and result.exists():
        fail(BAD_INPUT, f"--out: the file {result} already exists. Choose another name.")
    with bad_input(), shown_progress(progress, "trips") as tell:
        times = measure_trips(course, runs, jobs or usable_cores(), result, tell)
        text = map_times(times_matrix(times, len(place.rooms)))
        if result is not None:
            write_times(result, text)
    if to == STANDARD_OUTPUT:
        print(text, end="")  # noqa: T201 - the requested output
    for pair in times:
        for refusal in pair.refusals:
            note(f"{spoken_place(pair.start)} to {spoken_place(pair.goal)}: the robot did not arrive: {refusal}")
    if as_json:
        file = None if to is None else str(to)
        print_json({"map": place.name, "runs": runs, "file": file, "trips": [times_as_json(pair) for pair in times]})
    elif to != STANDARD_OUTPUT:
        show_times(times, f"{place.name}: mean seconds of {runs} trips each")
    unreached = sum(pair.mean is None for pair in times)
    if unreached:
        note(f"{unreached} of {len(times)} pairs of places have no time (99 in the file): no trip arrived.")
    if to != STANDARD_OUTPUT:
        note(_next_step(to, folder))
    if unreached:
        raise typer.Exit(FAILED)


def _next_step(to: Path | None, folder: Path) -> str:
    """Return sentences about the written file, and how to use it in games."""
    from thbridge.files.map_times import MAP_TIMES

    home = folder / MAP_TIMES
    if to is None:
        return f"No file was written. To use the times in games on this map, add `--out {home}`."
    if to.resolve() == home.resolve():
        return f"Wrote {to} into the map's folder. Games on this map now use these times."
    return f"Wrote {to}. To use it in games, copy it to {home}, or name it under `game: costs:` in the study."
