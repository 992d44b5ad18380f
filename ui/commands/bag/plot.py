"""`thbridge bag plot`: figures for papers."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from thbridge.analysis.plot.kinds import FigureKind
from thbridge.files.errors import visible
from ui.command_line.options import ProgressKind, ProgressOption
from ui.command_line.outputs import STANDARD_OUTPUT, destination, share_outputs
from ui.command_line.recordings import Estimated, Recording, Truth
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail, note


class FigureWidth(StrEnum):
    """Width of a figure, in columns of a page."""

    ONE = "one"
    TWO = "two"


def bag_plot(
    bag: Recording,
    what: Annotated[FigureKind, typer.Option(help="Figure to plot.")],
    to: Annotated[
        Path,
        typer.Option(help="File to write: a .png, .svg or .pdf. `-` is standard output, as SVG.", metavar="FILE"),
    ],
    width: Annotated[
        FigureWidth, typer.Option(help="Width of the figure, in columns of a page: `one` is 88 mm, `two` is 183 mm.")
    ] = FigureWidth.TWO,
    map_yaml: Annotated[
        Path | None, typer.Option("--map", help="Map (a map_server YAML file); default: the map in the bag.")
    ] = None,
    game: Annotated[
        int | None,
        typer.Option(help="Number of the game to plot, if the bag has several games. Times start at 0 in each game."),
    ] = None,
    truth: Truth = None,
    estimate: Estimated = None,
    progress: ProgressOption = ProgressKind.AUTO,
) -> None:
    """Plot a figure of a bag for a paper: paths, errors, covariance, energy, speeds, or a timeline of events."""
    from thbridge.analysis.plot.figures import draw
    from thbridge.analysis.plot.style import ONE_COLUMN, TWO_COLUMNS, FigureFormat
    from thbridge.analysis.report.builder import read_games, trajectory_topics
    from thbridge.files.disk.whole import write_whole
    from thbridge.files.progress import followed
    from thbridge.hunt.refusals import RequestRefused
    from thbridge.recording.bag.reading.reader import info, messages
    from ui.command_line.grids import grid_at
    from ui.command_line.progress import shown_progress

    kind = "svg" if to == STANDARD_OUTPUT else to.suffix.lower().removeprefix(".")
    if kind not in set(FigureFormat):
        fail(BAD_INPUT, f"--to: {to} is not a figure. Write a file name that ends in .png, .svg or .pdf.")
    look = ONE_COLUMN if width is FigureWidth.ONE else TWO_COLUMNS
    share_outputs()
    with bad_input(), shown_progress(progress, "bag plot") as tell:
        grid = None if map_yaml is None else grid_at(map_yaml)
        recorded = followed(messages(bag), "messages", info(bag).messages, tell)
        games = read_games(recorded, grid, trajectory_topics(bag, truth, estimate))
    report = games[0] if len(games) == 1 and game is None else next((one for one in games if one.game == game), None)
    if report is None:
        numbers = ", ".join(str(one.game) for one in games if one.game is not None) or "none"
        fail(BAD_INPUT, f"--game: {bag} has the games {numbers}. Write the number of the game to plot.")
    drawn = draw(what, report, look)
    if isinstance(drawn, RequestRefused):
        fail(FAILED, f"{bag}: {drawn.sentence}")
    with bad_input(), destination(to) as file:
        write_whole(file, look.rendered(drawn, FigureFormat(kind)), "choose another file with --to")
    for sentence in report.left_out:
        note(visible(sentence))
    for track in report.tracks:
        note(visible(f"{track.label}: {'; '.join(track.sources)}."))
    if to != STANDARD_OUTPUT:
        note(f"Figure: {to}")
