"""`thbridge sweep plot`: figures of a sweep."""

from pathlib import Path
from typing import Annotated

import typer

from thbridge.batch.bands import BandKind
from ui.command_line.outputs import STANDARD_OUTPUT, destination
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note
from ui.commands.bag.plot import FigureWidth
from ui.commands.sweep.sweep import FolderOfSweep


def sweep_plot(
    folder: FolderOfSweep,
    to: Annotated[
        Path,
        typer.Option(help="File to write: a .png, .svg or .pdf. `-` is standard output, as SVG.", metavar="FILE"),
    ],
    x: Annotated[str | None, typer.Option(help="Factor on the x axis; default: the first factor.")] = None,
    lines: Annotated[str | None, typer.Option(help="Factor shown as one line per level.")] = None,
    panels: Annotated[str | None, typer.Option(help="Factor shown as one panel per level.")] = None,
    measure: Annotated[str, typer.Option(help="Measure on the y axis.")] = "score",
    is_log: Annotated[bool, typer.Option("--log", help="Use a logarithmic x axis.")] = False,
    band: Annotated[
        BandKind,
        typer.Option(
            help="Method for the 95 % confidence interval of the mean: Student's t, or 2000 bootstrap samples."
        ),
    ] = BandKind.T,
    width: Annotated[
        FigureWidth, typer.Option(help="Width of the figure, in columns of a page: `one` is 88 mm, `two` is 183 mm.")
    ] = FigureWidth.TWO,
) -> None:
    """Plot the mean of a measure against a factor, with confidence intervals."""
    from thbridge.analysis.plot.style import ONE_COLUMN, TWO_COLUMNS, FigureFormat
    from thbridge.batch.figures import FigureAxes, curves_of, draw_curves
    from thbridge.batch.folder import read_manifest
    from thbridge.batch.tables import collect, numbers_of
    from thbridge.files.disk.whole import whole_file

    kind = "svg" if to == STANDARD_OUTPUT else to.suffix.lower().removeprefix(".")
    if kind not in set(FigureFormat):
        fail(BAD_INPUT, f"--to: {to} is not a figure. Write a file name that ends in .png, .svg or .pdf.")
    with bad_input():
        _, manifest = read_manifest(folder)
        table = collect(folder)
    if not manifest.factors:
        fail(BAD_INPUT, f"{folder}: this sweep has no factors to plot. Add factors to its design.")
    wanted = {"--x": x or manifest.factors[0], "--lines": lines, "--panels": panels}
    for option, factor in wanted.items():
        if factor is not None and factor not in manifest.factors:
            fail(
                BAD_INPUT,
                f"{option}: {factor!r} is not a factor of this sweep. Write one of {', '.join(manifest.factors)}.",
            )
    if is_log and not all(isinstance(level, int | float) and level > 0 for level in table[wanted["--x"]].to_pylist()):
        fail(BAD_INPUT, f"--log: not all levels of {wanted['--x']} are numbers above 0. Omit the option.")
    measures = numbers_of(table, manifest.measures)
    if measure not in measures:
        fail(
            BAD_INPUT,
            f"--measure: {measure!r} is not a numeric measure of these games. Write one of {', '.join(measures)}.",
        )
    axes = FigureAxes(measure, wanted["--x"] or "", lines, panels, band, is_log)
    look = ONE_COLUMN if width is FigureWidth.ONE else TWO_COLUMNS
    figure = draw_curves(curves_of(table, axes), axes, look)
    with bad_input(), destination(to) as file, whole_file(file, folders=True) as out:
        out.write(look.rendered(figure, FigureFormat(kind)))
    left = [factor for factor in manifest.factors if factor not in wanted.values()]
    if left:
        note(f"Games of all levels of {', '.join(left)} are pooled.")
    if to != STANDARD_OUTPUT:
        note(f"Figure: {to}")
