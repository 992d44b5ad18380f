"""HTML pages about a recording."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile
from thbridge.files.progress import Tell, untold
from ui.command_line.outputs import STANDARD_OUTPUT, destination
from ui.command_line.terminal import note

if TYPE_CHECKING:
    from sim.common.grid import OccupancyGrid
    from thbridge.analysis.report.tracks import TrajectoryTopics


def write_report(
    bag: Path, page: Path, map_yaml: Path | None = None, tell: Tell = untold, named: "TrajectoryTopics | None" = None
) -> None:
    """Write the report of a bag.

    Args:
        bag: recording.
        page: file to write.
        map_yaml: map to draw, instead of the map in the bag.
        `tell`: function that receives the progress.
        named: topics of a robot's trajectories, if the user named them.

    Raises:
        BadFile: the bag or the map cannot be read, or the page cannot be written.
    """
    # These imports take half a second, and only reports need them.
    from thbridge.analysis.report.tracks import FOUND_BY_NAME  # noqa: PLC0415
    from thbridge.analysis.report_page.page import build_report  # noqa: PLC0415

    write_page(bag, page, map_yaml, lambda grid: build_report(bag, grid, tell, named or FOUND_BY_NAME))
    if page != STANDARD_OUTPUT:
        note(f"Report: {page}")


def write_page(bag: Path, page: Path, map_yaml: Path | None, build: "Callable[[OccupancyGrid | None], str]") -> None:
    """Write a page about a bag.

    Args:
        bag: recording.
        page: file to write.
        map_yaml: map to draw, instead of the map in the bag.
        build: function that returns the page; it receives the map of `map_yaml`, or None.

    Raises:
        BadFile: the bag or the map cannot be read, or the page cannot be written.
    """
    if page.exists() and bag.exists() and page.samefile(bag):
        raise BadFile(page, "this is the bag itself", "choose another file with --to")
    grid = None
    if map_yaml is not None:
        from ui.command_line.grids import grid_at  # noqa: PLC0415 - imports 20 MB

        grid = grid_at(map_yaml)
    html = build(grid)
    with destination(page) as file:
        write_whole(file, html.encode(errors="replace"), "choose another file with --to")
