"""`thbridge bag export`: recordings as tables for pandas, R and similar programs."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from thbridge.files.errors import visible
from ui.command_line.options import AsJson, ProgressKind, ProgressOption
from ui.command_line.outputs import share_outputs
from ui.command_line.recordings import Recording
from ui.command_line.terminal import FAILED, bad_input, fail, note, print_json, say


class ExportFormat(StrEnum):
    """Formats of the tables."""

    CSV = "csv"
    PARQUET = "parquet"
    BOTH = "both"


def bag_export(
    bag: Recording,
    to: Annotated[Path, typer.Option(help="Folder to write to; must be new or empty.", metavar="FOLDER")],
    topics: Annotated[
        list[str] | None,
        typer.Option(help="Topics: names or patterns such as `*/scan`, separated by commas; default: all."),
    ] = None,
    tables: Annotated[
        list[str] | None,
        typer.Option(help="Tables, such as `poses,events`, separated by commas; default: all."),
    ] = None,
    form: Annotated[ExportFormat, typer.Option("--format", help="Format of the tables.")] = ExportFormat.PARQUET,
    start: Annotated[float, typer.Option("--from", help="Start, in seconds from the beginning.", min=0.0)] = 0.0,
    until: Annotated[
        float | None, typer.Option(help="End, in seconds from the beginning; default: the end of the bag.", min=0.0)
    ] = None,
    progress: ProgressOption = ProgressKind.AUTO,
    as_json: AsJson = False,
) -> None:
    """Export any ROS 1 bag as tables, one for each topic, with a data dictionary."""
    # Importing pyarrow here would slow down all commands.
    from thbridge.analysis.export.folder import export_bag
    from thbridge.files.tables.table_files import TableFormat
    from ui.command_line.progress import shown_progress
    from ui.commands.bag.choice import chosen_tables, chosen_topics, names_in

    share_outputs()
    with bad_input():
        chosen = chosen_topics(bag, names_in(topics)) if topics else None
        wanted = chosen_tables(bag, names_in(tables)) if tables else None
        formats = tuple(TableFormat) if form is ExportFormat.BOTH else (TableFormat(form),)
        with shown_progress(progress, "tables") as tell:
            exported = export_bag(bag, to, formats, chosen, start, until, wanted, tell)
    for notice in exported.notices:
        note(visible(notice))
    rows = {name: count for name, (_, count) in sorted(exported.tables.items())}
    if as_json:
        print_json({"folder": str(to), "rows": rows, "notices": exported.notices})
    else:
        total = sum(rows.values())
        say(f"{to}: {len(rows)} {'table' if len(rows) == 1 else 'tables'}, {total} rows, and README.md.")
    if not rows and exported.notices:
        fail(FAILED, f"{bag}: no topic could be exported.")
