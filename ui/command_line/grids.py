"""Maps that commands accept: a map.yaml, a folder with a map.yaml, or the name of a map that thbridge includes."""

from pathlib import Path

from sim.common.grid import OccupancyGrid
from thbridge.files.grid_files import read_grid_file
from thbridge.files.resources import shipped
from ui.command_line.terminal import note

MAP_YAML = "map.yaml"


def grid_at(named: Path) -> OccupancyGrid:
    """Return the occupancy grid of a map; print warnings about its file.

    Raises:
        BadFile: the map cannot be read.
    """
    if named.is_dir():
        named = named / MAP_YAML
    elif not named.exists() and str(named) in shipped().names("maps"):
        named = shipped().root / "maps" / named / MAP_YAML
    file = read_grid_file(named)
    for doubt in file.doubts:
        note(str(doubt))
    return file.grid
