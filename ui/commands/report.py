"""`thbridge report`."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import ProgressKind, ProgressOption
from ui.command_line.outputs import share_outputs
from ui.command_line.recordings import Estimated, Recording, Truth
from ui.command_line.terminal import bad_input


def report(
    bag: Recording,
    to: Annotated[
        Path | None, typer.Option(help="HTML file to write; default: next to the bag. `-` is standard output.")
    ] = None,
    map_yaml: Annotated[
        Path | None, typer.Option("--map", help="Map (a map_server YAML file); default: the map in the bag.")
    ] = None,
    truth: Truth = None,
    estimate: Estimated = None,
    progress: ProgressOption = ProgressKind.AUTO,
) -> None:
    """Write a report of a bag: one HTML page with paths, errors, energy, events and dialogues."""
    from thbridge.analysis.report.builder import trajectory_topics
    from ui.command_line.heap import give_large_blocks_back
    from ui.command_line.progress import shown_progress
    from ui.command_line.report import write_report

    give_large_blocks_back()
    if to is not None:
        share_outputs()
    with bad_input(), shown_progress(progress, "report") as tell:
        named = trajectory_topics(bag, truth, estimate)
        write_report(bag, to or bag.with_suffix(".html"), map_yaml, tell, named)
