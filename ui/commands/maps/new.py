"""`thbridge maps new` and `maps edit`: create an arena from any map, and edit it in a window."""

import unicodedata
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, ParamSpec

import typer

from ui.command_line.options import ColourScheme, LookOption, ProgressKind, ProgressOption
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, command, fail, say

P = ParamSpec("P")


def maps_new(
    source: Annotated[Path, typer.Argument(help="A map.yaml of map_server, or an image with dark walls.")],
    to: Annotated[
        Path | None, typer.Option(help="Folder to create; must not exist. Default: named after the file.")
    ] = None,
    resolution: Annotated[
        float | None, typer.Option(help="Meters per pixel, for an image without a map.yaml.", min=0.001, max=0.5)
    ] = None,
    width: Annotated[
        float | None, typer.Option(help="Width of the whole image in meters, instead of --resolution.", min=0.1)
    ] = None,
    height: Annotated[
        float | None,
        typer.Option(help="Height of the whole image in meters, if vertical and horizontal scale differ.", min=0.1),
    ] = None,
    turn: Annotated[
        float,
        typer.Option(
            help="Rotate the image counterclockwise by this many degrees, so that walls are parallel to x and y."
        ),
    ] = 0.0,
    thinner: Annotated[
        int | None,
        typer.Option(
            help="Remove lines and letters thinner than this many pixels (doors, furniture, labels), and fill "
            "hatching. With 0, every line is a wall.",
            min=0,
            max=100,
        ),
    ] = None,
    negate: Annotated[bool, typer.Option("--negate", help="Read an image with bright walls and a dark floor.")] = False,
    rooms: Annotated[
        int | None, typer.Option(help="Number of rooms; the largest rooms are used. Default: all.", min=1, max=999)
    ] = None,
    names: Annotated[
        str | None, typer.Option(help="Names of the rooms in the order of their numbers, separated by commas.")
    ] = None,
    robots: Annotated[int, typer.Option(help="Number of start poses.", min=1, max=64)] = 8,
    times: Annotated[bool, typer.Option("--times/--no-times", help="Measure the duration of each trip.")] = True,
    runs: Annotated[
        int, typer.Option(help="Number of trips from each place to each room; the mean time is used.", min=1)
    ] = 1,
    jobs: Annotated[
        int | None,
        typer.Option(help="Number of trips simulated at the same time; default: one per core.", min=1, max=256),
    ] = None,
    draw: Annotated[
        bool, typer.Option("--draw", help="Correct rooms and start poses in a window before any file is written.")
    ] = False,
    look: LookOption = ColourScheme.SYSTEM,
    progress: ProgressOption = ProgressKind.AUTO,
) -> None:
    """Create an arena (a map for games) from any map: find rooms, set goals and start poses, check, measure trips."""
    from thbridge.files.map_files import read_map
    from ui.command_line.progress import shown_progress
    from ui.commands.maps.drawing import (
        PaperSize,
        check_written,
        cleaned,
        find_arena,
        measure_map,
        note_size,
        read_drawing,
        require_rooms,
        write_map,
    )
    from ui.first_start.compiling import announce_compiling, usable_cores

    if draw:
        _require_window("Or omit --draw, and correct rooms.yaml as text")
    folder = to or Path(source.resolve().parent.name if source.stem == "map" else source.stem)
    if folder.exists():
        fail(BAD_INPUT, f"--to: {folder} already exists. Name a new folder.")
    called = [name.strip() for name in unicodedata.normalize("NFC", names).split(",")] if names else []
    if "" in called or len(set(called)) < len(called):
        fail(BAD_INPUT, f"--names: {names!r} has an empty or repeated name. Use a different name for each room.")
    if names is not None and ";" in names and "," not in names:
        fail(BAD_INPUT, f"--names: {names!r} is a single name. Separate names by commas.")
    if width is not None and resolution is not None:
        fail(BAD_INPUT, "--width, --resolution: both options set the size of the image. Omit one of the two.")
    with bad_input():
        whole = read_drawing(source, PaperSize(resolution, width, height, turn), negate)
    note_size(whole)
    drawing = cleaned(source, whole, thinner)
    grid = drawing.grid
    arena = find_arena(grid, rooms, robots, called)
    if len(called) > len(arena.rooms):
        problem = f"{len(called)} names, but {len(arena.rooms)} rooms were found"
        more = "add rooms with --draw, and name them there"
        more = f"set --rooms {len(called)}" if rooms == len(arena.rooms) else more
        fail(BAD_INPUT, f"--names: {problem}. Write fewer names, or {more}.")
    if draw:
        from ui.windows.arena import draw_arena

        draw_arena(
            folder.name,
            grid,
            arena,
            lambda drawn: _why_not(write_map, folder, drawing, drawn),
            look.value,
            left_out=drawing.left_out,
        )
        if not folder.exists():
            fail(FAILED, f"Nothing was saved. {folder} was not created.")
    else:
        require_rooms(arena, grid, source, negated=negate)
        with bad_input():
            write_map(folder, drawing, arena)
    check_written(folder)
    with bad_input():
        place = read_map(folder)
    complete = True
    if times:
        announce_compiling()
        with shown_progress(progress, "trips") as tell:
            complete = measure_map(folder, place, runs, jobs or usable_cores(), tell)
    else:
        measure = command("maps", "measure", folder, "--out", folder / "mapTimes")
        say(f"Trips were not measured, but games need travel times. Measure them: {measure}")
    say(f"Draw the map: {command('maps', 'check', folder, '--to', f'{folder.name}-rooms.png')}")
    path = folder if folder.is_absolute() else f"./{folder}"
    if times:
        say(f"Play on the map: {command('play', '--map', path)}")
    if not complete:
        raise typer.Exit(FAILED)


def maps_edit(
    folder: Annotated[Path, typer.Argument(help="Folder of your own map.")],
    look: LookOption = ColourScheme.SYSTEM,
) -> None:
    """Edit the rooms, goals and start poses of a map in a window; saving replaces its rooms.yaml."""
    from thbridge.files.map_files import check_map, write_rooms
    from thbridge.files.map_times import MAP_TIMES
    from thbridge.offline.arena import Arena
    from ui.commands.maps.drawing import check_written, read_left_out, same_trips

    _require_window(f"Or edit {folder / 'rooms.yaml'} as text, and check it with `thbridge maps check`")
    if not folder.is_dir():
        remedy = "Name the folder of your own map. To change a map that thbridge includes, copy it first"
        fail(BAD_INPUT, f"{folder}: there is no such folder. {remedy}.")
    check = check_map(folder)
    if check.map is None:
        fail(BAD_INPUT, "\n".join(str(fault) for fault in check.errors))
    from ui.windows.arena import draw_arena

    rooms, times = folder / "rooms.yaml", folder / MAP_TIMES
    old = times.with_name(f"{MAP_TIMES}.old")
    before, arena, measured = rooms.read_bytes(), Arena(check.map.rooms, check.map.starts), times.exists()
    saved, language = arena, check.map.language

    def write(drawn: Arena) -> None:
        nonlocal saved
        write_rooms(folder, drawn.rooms, drawn.starts, language=language)
        # Rename the old times now, because a game may start before the window is closed.
        if times.exists() and not same_trips(saved, drawn):
            times.replace(old)
        elif measured and not times.exists() and same_trips(arena, drawn):
            old.replace(times)
        saved = drawn

    with bad_input():
        left_out = read_left_out(folder, check.map.grid)
    draw_arena(
        check.map.name,
        check.map.grid,
        arena,
        lambda drawn: _why_not(write, drawn),
        look.value,
        is_saved=True,
        left_out=left_out,
    )
    if rooms.read_bytes() == before:
        return
    say(f"Wrote {rooms}")
    if measured and not times.exists():
        say(f"The old travel times no longer apply. Their file was renamed to {old}.")
    check_written(folder)
    if not times.exists():
        say(f"Games need travel times. Measure them: {command('maps', 'measure', folder, '--out', times)}")


def _require_window(otherwise: str) -> None:
    from ui.windows.display import why_no_window

    reason = why_no_window()
    if reason is not None:
        fail(BAD_INPUT, f"{reason} {otherwise}.")


def _why_not(write: Callable[P, object], *arguments: P.args, **named: P.kwargs) -> str | None:
    """Call a function that writes files; return the reason if it fails, otherwise None."""
    from thbridge.files.errors import BadFile, reason_of

    try:
        write(*arguments, **named)
    except BadFile as fault:
        return str(fault)
    except OSError as error:
        return f"The file cannot be written: {reason_of(error)}."
    return None
