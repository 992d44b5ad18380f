"""`thbridge watch`: the researcher's window."""

from pathlib import Path
from typing import Annotated

import typer

from ui.command_line.options import ColourScheme, LookOption
from ui.command_line.terminal import BAD_INPUT, bad_input, fail
from ui.windows.display import why_no_window

OPEN_TIMEOUT = 2.0
"""Time limit, in seconds, for opening a recording before its window is shown."""


def watch(
    what: Annotated[
        str | None,
        typer.Argument(
            metavar="[HOST:PORT|BAG]",
            help="Address of a running session (see `play --watch`), or path of a recording. Without it, choose in the "
            "window.",
        ),
    ] = None,
    key: Annotated[
        Path | None, typer.Option(help="File with the key that the session requires.", metavar="FILE")
    ] = None,
    look: LookOption = ColourScheme.SYSTEM,
) -> None:
    """Watch a running session or a recording: true poses next to the robots' beliefs, plots, messages, dialogues.

    In a running session, you can also send robots, move them by hand, kill their software, place obstacles, and speak
    for robots. All these actions are recorded. Press F1 for keyboard shortcuts. See `thbridge docs watching`.
    """
    from ui.windows.researcher.feeds.opening import open_feed

    with bad_input():
        opened = None if what is None else open_feed(what, key, OPEN_TIMEOUT)
    missing = why_no_window()
    if missing is not None:
        fail(BAD_INPUT, missing)
    from ui.windows.researcher.show import show

    show(opened, look.value)
    if opened is not None and opened.opener is not None and opened.opener.fault is not None:
        fail(BAD_INPUT, str(opened.opener.fault))
