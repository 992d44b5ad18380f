"""`thbridge maps new`: an arena made of a map that was not made for one."""

import os
from pathlib import Path
from typing import Annotated

import typer

from ui.terminal import BAD_INPUT, FAILED, bad_input, fail, say


def maps_new(
    source: Annotated[Path, typer.Argument(help="A map.yaml, as map_server reads it, or an image: walls are dark.")],
    to: Annotated[
        Path | None, typer.Option("--to", help="The folder to make; by default named as the file. Must not exist.")
    ] = None,
    resolution: Annotated[
        float | None, typer.Option(help="Metres a pixel; for images without a map.yaml.", min=0.001, max=10)
    ] = None,
    negate: Annotated[bool, typer.Option("--negate", help="The image's walls are bright, its floor is dark.")] = False,
    rooms: Annotated[
        int | None, typer.Option(help="Rooms wanted; the largest are taken. By default all.", min=1, max=999)
    ] = None,
    names: Annotated[
        str | None, typer.Option(help="Names of the rooms as they are numbered, with commas between.")
    ] = None,
    robots: Annotated[int, typer.Option(help="Start poses wanted.", min=1, max=64)] = 8,
    times: Annotated[bool, typer.Option("--times/--no-times", help="Measure what every trip takes.")] = True,
    runs: Annotated[int, typer.Option(help="Trips from each place to each room; their mean counts.", min=1)] = 1,
    jobs: Annotated[
        int | None, typer.Option(help="Trips driven at a time; by default one on every core.", min=1, max=256)
    ] = None,
) -> None:
    """Make an arena of any map: find its rooms, put goals and start poses, check it, measure its trips."""
    from thbridge.files.map_files import read_map
    from ui.actions.new_map import find_arena, measure_map, read_drawing, require_rooms, write_map
    from ui.first_start import announce_compiling

    folder = to or Path(source.resolve().parent.name if source.stem == "map" else source.stem)
    if folder.exists():
        fail(BAD_INPUT, f"--to: {folder} is there already. Name a folder that is to be made.")
    called = [name.strip() for name in names.split(",")] if names else []
    if "" in called or len(set(called)) < len(called):
        fail(BAD_INPUT, f"--names: {names!r} has an empty name or one twice. Give every room its own name.")
    with bad_input():
        grid = read_drawing(source, resolution, negate)
    width, height = grid.cols * grid.resolution, grid.rows * grid.resolution
    say(f"Map: {width:.1f} m x {height:.1f} m, {grid.cols} x {grid.rows} cells of {grid.resolution:g} m")
    arena = find_arena(grid, rooms, robots, called)
    require_rooms(arena, grid, source)
    if len(called) > len(arena.rooms):
        fail(
            BAD_INPUT,
            f"--names: {len(called)} names for {len(arena.rooms)} rooms. Leave {len(called) - len(arena.rooms)} out.",
        )
    with bad_input():
        write_map(folder, grid, arena)
        place = read_map(folder)
    complete = True
    if times:
        announce_compiling()
        complete = measure_map(folder, place, runs, jobs or os.cpu_count() or 1)
    else:
        say(f"Not measured. Games need times: thbridge maps measure {folder} --out {folder / 'mapTimes'}")
    say(f"Look at it: thbridge maps check {folder} --to {folder.name}-rooms.png")
    path = folder if folder.is_absolute() else f"./{folder}"
    if times:
        say(f"Play on it: thbridge play --map {path}")
    if not complete:
        raise typer.Exit(FAILED)
