"""List of the finished games of an unfinished chunk. A restarted chunk plays only the other games."""

import json
from collections.abc import Iterable, Mapping
from pathlib import Path

import msgspec

from thbridge.app.compose.machine import versions
from thbridge.batch.folder import SweepFolder
from thbridge.batch.results import GameResult
from thbridge.files.disk.own_links import own_target
from thbridge.files.disk.regular_files import content_of
from thbridge.files.errors import BadFile, reason_of
from thbridge.recording.append import append_whole
from thbridge.recording.recordings import finished_of

_LARGEST = 1 << 28


def read_ended(folder: SweepFolder, path: Path, plugins: Iterable[str] = ()) -> Mapping[int, GameResult]:
    """Return the ended games of a chunk, by seed. Ignore games of other versions and games with missing bags.

    Args:
        folder: folder of the sweep.
        path: path of the chunk's file.
        plugins: keys of the plug-ins that the sweep's studies name.

    Raises:
        BadFile: the file cannot be read, or is too large.
    """
    try:
        head, *lines = content_of(path, _LARGEST).splitlines() or [b""]
    except FileNotFoundError:
        return {}
    except OSError as error:
        problem = f"the file cannot be read ({reason_of(error)})"
        raise BadFile(path, problem, "Delete this file, and run the sweep again") from None
    if head != _head(plugins):
        return {}
    found = {}
    for line in lines:
        try:
            game = msgspec.json.decode(line, type=GameResult)
        except (msgspec.MsgspecError, RecursionError):
            continue  # A killed program left an incomplete line.
        if game.bag is None or finished_of(folder.root / game.bag):
            found[game.seed] = game
    return found


def keep_ended(path: Path, game: GameResult, plugins: Iterable[str] = ()) -> None:
    """Append a game to the list. For `plugins`, see `read_ended`. Raises BadFile if the file cannot be written."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with own_target(path).open("ab", buffering=0) as file:
            # A killed program may have left an incomplete line; the newline in front ends this line.
            head = _head(plugins) if file.tell() == 0 else b""
            append_whole(file, head + b"\n" + msgspec.json.encode(game) + b"\n", synced=False)
    except OSError as error:
        remedy = "free some space, then run the command again"
        raise BadFile(path, f"it cannot be written ({reason_of(error)})", remedy) from None


def _head(plugins: Iterable[str]) -> bytes:
    return json.dumps(versions(plugins), sort_keys=True).encode()
