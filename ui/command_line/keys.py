"""Keys of programs and windows: the keys that a session accepts, and the key that a client presents."""

from pathlib import Path

from thbridge.files.keys.certificate import certificate_of
from thbridge.files.keys.key_file import ClientKey, read_key
from thbridge.files.keys.key_ring import SHORTEST_KEY, KeyRing
from thbridge.sockets.keys import KeyVerifier, RingKeys, SingleKey
from thbridge.sockets.tls import server_context
from thbridge.study.study_file import Study
from thbridge.timing.wall_clock import utc_now
from ui.command_line.terminal import BAD_INPUT, bad_input, command, fail


def key_of(path: Path) -> ClientKey:
    """Return the key in a file that only its owner can read."""
    with bad_input():
        return read_key(path)


def keys_of(study: Study, file: Path | None, folder: Path | None) -> RingKeys | None:
    """Return the keys of programs and windows on other machines; if None, the session accepts no keys.

    If `folder` is given, it replaces the folder that the study names.
    """
    beside = Path() if file is None else file.parent
    path = folder or (None if study.keys is None else beside / study.keys)
    if path is not None and not path.is_dir():
        make = command("keys", "new", "NAME", "--keys", path)
        fail(BAD_INPUT, f"keys: there is no folder {path}. Create the folder and a key: {make}")
    return None if path is None else _ring_keys("keys", path)


def _ring_keys(option: str, folder: Path) -> RingKeys:
    with bad_input():
        ring = KeyRing(folder, utc_now)
        if not ring.entries:
            make = command("keys", "new", "NAME", "--keys", folder)
            fail(BAD_INPUT, f"{option}: there are no keys in {folder}. Create a key: {make}")
        return RingKeys(ring, server_context(certificate_of(folder, utc_now())))


def watch_keys(path: Path) -> KeyVerifier:
    """Return the keys at a path: a folder of `thbridge keys`, or a file with one key that has all rights."""
    if path.is_dir():
        return _ring_keys("--watch-key", path)
    key = key_of(path).secret
    if len(key) < SHORTEST_KEY:
        problem = f"{path}: this key is easy to guess, because it has only {len(key)} characters"
        remedy = f"Use at least {SHORTEST_KEY} random characters, or create a key: {command('keys', 'new', 'NAME')}"
        fail(BAD_INPUT, f"{problem}. {remedy}")
    return SingleKey(key)
