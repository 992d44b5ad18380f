"""`thbridge sweep status` and `sweep collect`: the status of a sweep, and the table of its games."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import AsJson
from ui.command_line.outputs import STANDARD_OUTPUT, destination
from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note, print_json

FolderOfSweep = Annotated[Path, typer.Argument(help="Folder of a sweep.", metavar="DIR")]


def sweep_status(folder: FolderOfSweep, as_json: AsJson = False) -> None:
    """Print how many games of a sweep are done, missing, failed and verified, and the time left."""
    import dataclasses

    from thbridge.batch.status import status_of
    from ui.commands.sweep.telling import show_status

    with bad_input():
        status = status_of(folder)
    if as_json:
        print_json(dataclasses.asdict(status))
    else:
        show_status(status)


def sweep_collect(
    folder: FolderOfSweep,
    to: Annotated[
        Path,
        typer.Option(help="File to write: a .csv or .parquet. `-` is standard output, as CSV.", metavar="FILE"),
    ],
) -> None:
    """Write one table of all games played so far: one row per game, with condition, factors, seed and measures."""
    from thbridge.batch.tables import collect, write_collected
    from thbridge.files.tables.table_files import TableFormat

    kind = "csv" if to == STANDARD_OUTPUT else to.suffix.lower().removeprefix(".")
    if kind not in set(TableFormat):
        fail(BAD_INPUT, f"--to: {to} is not a table. Write a file name that ends in .csv or .parquet.")
    with bad_input():
        table = collect(folder)
        with destination(to, ".csv") as file:
            write_collected(table, file, TableFormat(kind))
    if to != STANDARD_OUTPUT:
        note(f"Wrote {table.num_rows} games to {to}.")
