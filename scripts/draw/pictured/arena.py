"""Window for drawing an arena, with the rooms that were found on a map."""

from collections.abc import Iterator

import numpy as np

from pictured.shot import Shot, Story
from sim.robot.costmap.footprint import radii
from thbridge.files.grid_files import read_grid
from thbridge.files.map_files import FOOTPRINT
from thbridge.files.resources import shipped
from thbridge.offline.arena import arena_of
from thbridge.offline.room_finding import find_rooms
from ui.model.arena.draft import ArenaTool
from ui.windows.arena.window import ArenaWindow

SIZE = (1240, 860)


def drawing() -> Iterator[Shot]:
    """Yield found rooms with one selected room, a line across a room, and a refused change."""
    grid = read_grid(shipped().root / "maps" / "office" / "map.yaml")
    found = find_rooms(grid, *radii(np.array(FOOTPRINT)))
    window = ArenaWindow("office", grid, arena_of(grid, found, 3, ("Reception", "Library")), lambda _: None)
    window.resize(*SIZE)
    window.show()
    room = window.draft.arena.rooms[1]
    window.list.setCurrentRow(1)
    yield shot("arena", window)
    window.take_tool(ArenaTool.CUT)
    outline = np.array(room.region)
    middle, half = outline.mean(axis=0), np.ptp(outline, axis=0) / 2 + 0.5
    window.pointer.press(middle[0], middle[1] - half[1], 0.1)
    window.pointer.drag(middle[0], middle[1] + half[1])
    window.show_all()
    yield shot("arena-cut", window)
    window.pointer.release()
    window.take_tool(ArenaTool.MOVE)
    window.list.setCurrentRow(0)
    window.change(lambda: window.draft.rename(1, ""))
    yield shot("arena-refused", window)
    window.draft.saved()
    window.close()


def shot(name: str, window: ArenaWindow) -> Shot:
    """Return a picture of the window."""
    return Shot(name, window, lambda _: window.repaint_all())


STORIES = (
    Story(
        "The admin: an arena",
        {
            "arena": "Rooms found on a map; room 2 is selected",
            "arena-cut": "A line divides a room into two",
            "arena-refused": "A room needs a name",
        },
        drawing,
    ),
)
