"""Window for drawing an arena."""

from collections.abc import Callable

from sim.common.grid import OccupancyGrid
from sim.common.traversability import Mask
from thbridge.offline.arena import Arena
from ui.windows.application import application
from ui.windows.arena.window import ArenaWindow
from ui.windows.look import Choice
from ui.windows.preferences import preferences_of


def draw_arena(
    name: str,
    grid: OccupancyGrid,
    arena: Arena,
    write: Callable[[Arena], str | None],
    choice: Choice = "system",
    *,
    is_saved: bool = False,
    left_out: Mask | None = None,
) -> int:
    """Open the window, wait until it is closed, and return the program's exit code.

    Args:
        name: name of the map.
        grid: cells of the map.
        arena: rooms and start poses to start with.
        write: function that writes the arena. It returns the reason for a failure, or None.
        choice: light, dark, or the system's colors.
        is_saved: True if `arena` is already saved in a file.
        left_out: (rows, cols) True for cells of removed lines, which the window shows. None if no lines were removed.
    """
    app = application()
    preferences = preferences_of(app, "arena", choice)
    window = ArenaWindow(name, grid, arena, write, is_saved=is_saved, left_out=left_out)
    preferences.changed.connect(window.repaint_all)
    preferences.add_keys(window)
    preferences.keep_place(window)
    window.show()
    return app.exec()
