"""`thbridge maps new` and `maps edit`: arenas made of maps that were not made for one, and drawn by hand."""

import unicodedata
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, ParamSpec

import typer

from ui.command_line.options import ColourScheme, LookOption, ProgressKind, ProgressOption
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, command, fail, say

P = ParamSpec("P")


def maps_new(
    source: Annotated[Path, typer.Argument(help="A map.yaml, as map_server reads it, or an image: walls are dark.")],
    to: Annotated[
        Path | None, typer.Option(help="The folder to make; by default named as the file. Must not exist.")
    ] = None,
    resolution: Annotated[
        float | None, typer.Option(help="Metres a pixel; for images without a map.yaml.", min=0.001, max=0.5)
    ] = None,
    width: Annotated[
        float | None, typer.Option(help="Width of the whole image in meters, instead of --resolution.", min=0.1)
    ] = None,
    height: Annotated[
        float | None,
        typer.Option(help="Height of the whole image in meters, if its vertical scale differs.", min=0.1),
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
            help="Leave out lines and letters thinner than this many pixels (doors, furniture, labels), and fill "
            "hatching. 0: every line is a wall.",
            min=0,
            max=100,
        ),
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
    draw: Annotated[bool, typer.Option("--draw", help="Correct rooms and start poses in a window first.")] = False,
    look: LookOption = ColourScheme.SYSTEM,
    progress: ProgressOption = ProgressKind.AUTO,
) -> None:
    """Make an arena of any map: find its rooms, put goals and start poses, check it, measure its trips."""
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
        _require_window("Or leave --draw out, and correct rooms.yaml as text")
    folder = to or Path(source.resolve().parent.name if source.stem == "map" else source.stem)
    if folder.exists():
        fail(BAD_INPUT, f"--to: {folder} is there already. Name a folder that is to be made.")
    called = [name.strip() for name in unicodedata.normalize("NFC", names).split(",")] if names else []
    if "" in called or len(set(called)) < len(called):
        fail(BAD_INPUT, f"--names: {names!r} has an empty name or one twice. Give every room its own name.")
    if names is not None and ";" in names and "," not in names:
        fail(BAD_INPUT, f"--names: {names!r} is one name. Write commas between names.")
    if width is not None and resolution is not None:
        fail(BAD_INPUT, "--width, --resolution: each says how large the image is. Leave one of the two out.")
    with bad_input():
        whole = read_drawing(source, PaperSize(resolution, width, height, turn), negate)
    note_size(whole)
    drawing = cleaned(source, whole, thinner)
    grid = drawing.grid
    arena = find_arena(grid, rooms, robots, called)
    if len(called) > len(arena.rooms):
        problem = f"{len(called)} names, but {len(arena.rooms)} rooms were found"
        more = "add rooms by --draw, and name them there"
        more = f"ask for them by --rooms {len(called)}" if rooms == len(arena.rooms) else more
        fail(BAD_INPUT, f"--names: {problem}. Give fewer; or {more}.")
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
            fail(FAILED, f"Nothing was saved, so there is no {folder}.")
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
        say(f"Not measured. Games need times: {command('maps', 'measure', folder, '--out', folder / 'mapTimes')}")
    say(f"Look at it: {command('maps', 'check', folder, '--to', f'{folder.name}-rooms.png')}")
    path = folder if folder.is_absolute() else f"./{folder}"
    if times:
        say(f"Play on it: {command('play', '--map', path)}")
    if not complete:
        raise typer.Exit(FAILED)


def maps_edit(
    folder: Annotated[Path, typer.Argument(help="Folder of a map of yours.")],
    look: LookOption = ColourScheme.SYSTEM,
) -> None:
    """Edit a map's rooms, goals and start poses in a window; saving writes its rooms.yaml anew."""
    from thbridge.files.map_files import check_map, write_rooms
    from thbridge.files.map_times import MAP_TIMES
    from thbridge.offline.arena import Arena
    from ui.commands.maps.drawing import check_written, read_left_out, same_trips

    _require_window(f"Or edit {folder / 'rooms.yaml'} as text, and check it by `thbridge maps check`")
    if not folder.is_dir():
        fail(
            BAD_INPUT, f"{folder}: there is no such folder. Give that of a map of yours; a shipped one is copied first."
        )
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
        # At once, not when the window is closed: a game may begin before.
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
        say(f"The times were of other trips; they are now {old}.")
    check_written(folder)
    if not times.exists():
        say(f"Games need times: {command('maps', 'measure', folder, '--out', times)}")


def _require_window(otherwise: str) -> None:
    from ui.windows.display import why_no_window

    reason = why_no_window()
    if reason is not None:
        fail(BAD_INPUT, f"{reason} {otherwise}.")


def _why_not(write: Callable[P, object], *arguments: P.args, **named: P.kwargs) -> str | None:
    """Write something; return the reason why that failed, or None."""
    from thbridge.files.errors import BadFile, reason_of

    try:
        write(*arguments, **named)
    except BadFile as fault:
        return str(fault)
    except OSError as error:
        return f"It cannot be written: {reason_of(error)}."
    return None
