"""`thbridge desktop`: the researcher's window in the desktop's menu, and as the default program for bags."""

import sys

from ui.command_line.terminal import BAD_INPUT, bad_input, fail, note, say


def desktop_install() -> None:
    """Install the menu entry, the file types of bags and the icon, for the current user only."""
    from ui.commands.desktop.files import data_home, install, installed_program

    if sys.platform in {"darwin", "win32"}:
        fail(BAD_INPUT, "Menu entries and file types need Linux. Start `thbridge watch`, and open bags with *Open…*.")
    with bad_input():
        for path in install(data_home(), installed_program()):
            say(str(path))
    note("Bags now open in `thbridge watch`. To undo this, run `thbridge desktop remove`.")


def desktop_remove() -> None:
    """Remove the files that `desktop install` wrote."""
    from ui.commands.desktop.files import data_home, remove

    removed = list(remove(data_home()))
    for path in removed:
        say(str(path))
    if not removed:
        note("Nothing was removed, because nothing is installed.")
