"""The window in which an arena is drawn."""

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
    """Open the window and wait until it is closed; return the program's exit code.

    Args:
        name: of the map.
        grid: its cells.
        arena: rooms and start poses to begin with.
        write: writes what was drawn; returns why it cannot, or None.
        choice: light, dark or as the system is.
        is_saved: True when the arena to begin with is in a file already.
        left_out: (rows, cols) cells of lines that were left out of the plan, to be shown; or None.
    """
    app = application()
    preferences = preferences_of(app, "arena", choice)
    window = ArenaWindow(name, grid, arena, write, is_saved=is_saved, left_out=left_out)
    preferences.changed.connect(window.repaint_all)
    preferences.add_keys(window)
    preferences.keep_place(window)
    window.show()
    return app.exec()
