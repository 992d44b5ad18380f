"""Houses with room for a large team."""

import re
import shutil
from pathlib import Path

import numpy as np

from sim.common.geometry import Pose2
from sim.common.grid import OccupancyGrid, distance_field
from thbridge.files.resources import shipped


def hall_for_fifty(folder: Path) -> Path:
    """The warehouse with starts for fifty, in a folder below this one."""
    hall = folder / "warehouse"
    shutil.copytree(shipped().find("maps", "warehouse12", Path()), hall)
    rooms = hall / "rooms.yaml"
    ends = [(2.4, 5.6, 2.0), (2.4, 5.6, 2.9), (2.4, 3.2, 3.8), (9.0, 12.2, 1.9), (9.0, 12.2, 2.9), (9.0, 12.2, 4.6)]
    rows = "".join(f"\n    - [[{first}, {y}], [{last}, {y}]]" for first, last, y in ends)
    text = rooms.read_text().replace("\n  rows:", f"\n  rows:{rows}")
    rooms.write_text(re.sub(r"spacing: .*", "spacing: 0.8", text))
    return hall


def free_places(grid: OccupancyGrid, spacing: float) -> list[Pose2]:
    """Places on a lattice, metres, at which robots may stand and turn, in an order that mixes them."""
    room = distance_field(grid, 2.0)
    places = [
        Pose2(float(x), float(y), 0.0)
        for y in np.arange(grid.origin.y + 0.5, grid.origin.y + grid.rows * grid.resolution, spacing)
        for x in np.arange(grid.origin.x + 0.5, grid.origin.x + grid.cols * grid.resolution, spacing)
        if grid.contains(*grid.cell_of(x, y)) and room[grid.cell_of(x, y)] > 0.45
    ]
    return [places[index] for index in np.random.default_rng(0).permutation(len(places))]
