"""Key ring: names, rights and digests of the keys that admit people. Only these people have the secrets."""

import contextlib
import fcntl
import hashlib
import os
import re
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import msgspec

from thbridge.credentials import Right
from thbridge.files.disk.inside import path_inside
from thbridge.files.disk.regular_files import content_of
from thbridge.files.disk.synced import make_folder
from thbridge.files.disk.whole import whole_file, write_whole
from thbridge.files.errors import BadFile, reason_of
from thbridge.files.keys.certificate import certificate_of
from thbridge.files.keys.key_file import key_text
from thbridge.files.keys.private_file import check_private

RING = "ring.json"
"""The file of a ring, in its folder."""
KEY_SUFFIX = ".key"
"""Suffix of a file with one secret."""
SHORTEST_KEY = 16
"""Smallest number of characters of a secret, so that it cannot be guessed."""

_LOCK_TRIES, _LOCK_SECONDS = 20, 0.01
_NAME = re.compile(r"[a-z][a-z0-9_-]{0,31}")


class KeyEntry(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """A key of a ring.

    Attributes:
        name: name of the person or program that has the key.
        rights: rights of the holder; intervening includes watching, and admin includes everything.
        digest: SHA-256 of the secret, which itself has 256 bits and cannot be guessed.
        created: date and time, UTC.
        expires: date and time from which the key is invalid. If None, the key does not expire.
        revoked: date and time at which the key was revoked. If None, the key was not revoked.
        game: the only game for which a participant's key is valid. If None, the first game that uses the key.
        seats: names of the seats that a participant's program with this key may take; empty for all.
    """

    name: str
    rights: tuple[Right, ...]
    digest: str
    created: str
    expires: str | None = None
    revoked: str | None = None
    game: str | None = None
    seats: tuple[str, ...] = ()

    def why_not(self, now: str) -> str | None:
        """Return the reason why the key is invalid at a date and time, as a clause, or None if it is valid."""
        if self.revoked is not None:
            return f"the key {self.name} was revoked"
        if self.expires is not None and now >= self.expires:
            return f"the key {self.name} has expired"
        return None


class KeyRing:
    """Keys in a folder. Changes that other programs make take effect at once.

    Args:
        folder: folder of the ring; the folder does not have to exist.
        clock: returns the date and time, UTC, in the ring's format.

    Raises:
        BadFile: the ring is damaged, or other accounts may read it.
    """

    def __init__(self, folder: Path, clock: Callable[[], str]) -> None:
        self.folder = folder
        self._clock = clock
        self._path = folder / RING
        self._state: tuple[int, int] | None = None
        self._entries: tuple[KeyEntry, ...] = ()
        self._read()

    @property
    def entries(self) -> tuple[KeyEntry, ...]:
        """All keys, oldest first. Raises BadFile."""
        self._read()
        return self._entries

    def holder(self, secret: str) -> KeyEntry | str:
        """Return the key with this secret, or the reason, as a clause, why it is invalid. Raises BadFile."""
        digest = _digest(secret)
        for entry in self.entries:
            if entry.digest == digest:
                return entry.why_not(self._clock()) or entry
        return "the key is wrong"

    def why_not(self, name: str) -> str | None:
        """Return the reason why a key is no longer valid, or None if it is valid. Raises BadFile."""
        entry = next((entry for entry in self.entries if entry.name == name), None)
        return f"there is no key {name}" if entry is None else entry.why_not(self._clock())

    def add(
        self, name: str, rights: Sequence[Right], secret: str, expires: str | None, seats: Sequence[str] = ()
    ) -> Path:
        """Add a key, write it into a file for its holder, and return that file; the arguments are as in `KeyEntry`.

        The file also has the fingerprint of the folder's certificate, which is created if it does not exist.

        Raises:
            BadFile: the name is invalid or taken, or a file cannot be written.
        """
        if _NAME.fullmatch(name) is None:
            problem = f"{name!r} is not a valid name of a key"
            raise BadFile(self._path, problem, "use lower-case letters, digits, - and _; begin with a letter")
        path = path_inside(self.folder, f"{name}{KEY_SUFFIX}")
        with self._locked():
            if any(entry.name == name for entry in self.entries):
                remedy = "choose another name; a name is never used again"
                raise BadFile(self._path, f"a key {name} already exists", remedy)
            certificate = certificate_of(self.folder, self._clock())
            try:
                with whole_file(path, "choose another folder", exclusive=True, mode=0o600) as file:
                    file.write(key_text(secret, certificate.fingerprint).encode())
            except FileExistsError:
                problem = f"this file exists, but no key {name}: it is unfinished, or belongs to another program"
                raise BadFile(path, problem, "move the file to another folder, then try again") from None
            try:
                entry = KeyEntry(name, tuple(rights), _digest(secret), self._clock(), expires, seats=tuple(seats))
                self._write((*self._entries, entry))
            except BadFile:
                path.unlink()
                raise
        return path

    def revoke(self, name: str) -> None:
        """Revoke a key. Raises BadFile if no key has this name."""
        with self._locked():
            entry = next((entry for entry in self.entries if entry.name == name), None)
            if entry is None:
                names = ", ".join(entry.name for entry in self._entries) or "none"
                raise BadFile(self._path, f"there is no key {name}", f"name one of these: {names}")
            self._replace(msgspec.structs.replace(entry, revoked=entry.revoked or self._clock()))

    def enter(self, name: str, game: str, *, over: bool = False) -> str | None:
        """Use a participant's key for a game. From then on the key is valid only for this game.

        Args:
            name: name of the key.
            game: unique name of the game.
            over: True if the game is over; then an unused key is kept for the next game.

        Returns:
            The reason why the key is not valid for this game, as a clause, or None if it is valid.

        Raises:
            BadFile: the ring cannot be read or written.
        """
        entry = next((entry for entry in self.entries if entry.name == name), None)
        if entry is None:
            return f"there is no key {name}"
        if entry.game is None and not over:
            with self._locked():
                entry = next(entry for entry in self.entries if entry.name == name)
                if entry.game is None:
                    self._replace(msgspec.structs.replace(entry, game=game))
        return None if entry.game in (None, game) else f"the key {name} was for one game, which is over"

    @contextmanager
    def _locked(self) -> Iterator[None]:
        """Prevent other programs from changing the ring. Raises BadFile."""
        before = os.umask(0o077)
        try:
            make_folder(self.folder)
            opened = os.open(self.folder, os.O_RDONLY | os.O_DIRECTORY)
            locked = _lock(opened)
        except OSError as error:
            raise BadFile(self.folder, f"it cannot be opened ({reason_of(error)})", "choose another folder") from None
        finally:
            os.umask(before)
        try:
            if not locked:
                raise BadFile(self.folder, "another program is changing these keys", "try again in a moment")
            yield
        finally:
            os.close(opened)

    def _replace(self, entry: KeyEntry) -> None:
        self._write(tuple(entry if each.name == entry.name else each for each in self._entries))

    def _write(self, entries: tuple[KeyEntry, ...]) -> None:
        text = msgspec.json.format(msgspec.json.encode(entries), indent=2)
        write_whole(self._path, text + b"\n", mode=0o600)
        self._read()

    def _read(self) -> None:
        try:
            found = self._path.stat()
        except FileNotFoundError:
            self._state, self._entries = None, ()
            return
        except OSError as error:
            raise BadFile(self._path, f"it cannot be read ({reason_of(error)})", "name another folder") from None
        state = found.st_mtime_ns, found.st_ino
        if state == self._state:
            return
        check_private(self._path)
        try:
            self._entries = msgspec.json.decode(content_of(self._path), type=tuple[KeyEntry, ...])
        except OSError as error:
            raise BadFile(self._path, f"it cannot be read ({reason_of(error)})", "name another folder") from None
        except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
            problem = f"this is not a ring of keys ({error})"
            raise BadFile(self._path, problem, "create a new ring in another folder: thbridge keys new") from None
        self._state = state


def _lock(opened: int) -> bool:
    """Lock a folder.

    Other programs hold the lock only for a few milliseconds. Give up after a while, so that a session never hangs.
    """
    for _ in range(_LOCK_TRIES):
        with contextlib.suppress(BlockingIOError):
            fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return True
        time.sleep(_LOCK_SECONDS)
    return False


def _digest(secret: str) -> str:
    return hashlib.sha256(secret.encode(errors="surrogatepass")).hexdigest()
