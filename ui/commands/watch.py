"""`thbridge watch`: the researcher's window."""

import re
from pathlib import Path
from typing import Annotated

import typer

from thbridge.files.keys.key_file import ClientKey
from ui.display import why_no_window
from ui.options import ColourScheme, LookOption
from ui.terminal import BAD_INPUT, fail

ADDRESS = re.compile(r"(?P<host>[^\s/]+):(?P<port>[0-9]{1,5})")
OPEN_TIMEOUT = 2.0
"""Seconds that a recording may take to open before its window does."""


def watch(
    what: Annotated[
        str,
        typer.Argument(metavar="HOST:PORT|BAG", help="The door of a session (its option --watch), or a recording."),
    ],
    key: Annotated[
        Path | None, typer.Option(help="File with the key that the session's door wants.", metavar="FILE")
    ] = None,
    look: LookOption = ColourScheme.SYSTEM,
) -> None:
    """Watch a session under way, or a recording: the truth beside what robots believe, plots, lines, dialogue.

    At a session the window also sends robots, kidnaps and kills them, puts things in their way and speaks for them;
    whatever it asks is recorded. Keys are told by F1. See docs/watching.md.
    """
    from ui.door_keys import key_of

    address = ADDRESS.fullmatch(what)
    if address is not None and not Path(what).exists():
        port = int(address["port"])
        if not 0 < port < 65536:
            fail(BAD_INPUT, f"{what}: {port} is not a port. Give the number that the session told, 1 to 65535.")
        _watch_session(address["host"], port, None if key is None else key_of(key), look)
    elif key is not None:
        fail(BAD_INPUT, f"--key: {what} is not HOST:PORT, and a recording wants no key. Leave the option out.")
    else:
        _watch_recording(Path(what), look)


def _watch_session(host: str, port: int, key: ClientKey | None, look: ColourScheme) -> None:
    _need_window()
    from thbridge.sockets.watching.client import WatchClient
    from ui.windows.researcher.feeds.session import SessionFeed, WatchConnection
    from ui.windows.researcher.show import show

    address = f"{host}:{port}"
    show(SessionFeed(WatchConnection(WatchClient(host, port, key)), address), address, look.value)


def _watch_recording(path: Path, look: ColourScheme) -> None:
    from ui.windows.researcher.feeds.recording import BagOpener, RecordingFeed

    opening = BagOpener(path)
    if opening.wait(OPEN_TIMEOUT) and opening.fault is not None:
        fail(BAD_INPUT, str(opening.fault))
    _need_window()
    from ui.windows.researcher.show import show

    show(RecordingFeed(opening), path.name, look.value)
    if opening.fault is not None:
        fail(BAD_INPUT, str(opening.fault))


def _need_window() -> None:
    missing = why_no_window()
    if missing is not None:
        fail(BAD_INPUT, missing)
