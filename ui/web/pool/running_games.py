"""Folder of a server's running games: a server that is started again finds the workers of the one before it."""

import fcntl
import hashlib
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import IO
from urllib.parse import urlsplit

import msgspec

from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile, reason_of
from ui.web.pool.messages import WorkerResult

_GAME, _RESULT, _SOCKET, _REMOTE, _HISTORY, _GROUP = ".game", ".result", ".sock", ".remote", ".history", ".group"
_RESULTS = msgspec.json.Decoder(WorkerResult)
_OTHERS = 0o077
_DIGEST = 16
_TRIES, _LOOK = 20, 0.02


class WorkerAddress(msgspec.Struct, frozen=True):
    """Address of a worker.

    Attributes:
        socket: path of its socket; on another machine, its address, such as `tls://10.0.0.2:41234`.
        token: its secret.
        process: number of its process on its machine.
    """

    socket: str
    token: str
    process: int

    @property
    def host(self) -> str:
        """Host of a worker on another machine; empty for a worker on this machine."""
        return urlsplit(self.socket).hostname or "" if "://" in self.socket else ""


class GroupRecord(msgspec.Struct, frozen=True):
    """People who play one game of a study file.

    Attributes:
        bag: path of the recording.
        people: key of each person who has not finished the game, by seat.
        consents: times at which people gave consent, by seat; empty texts if they were not asked.
    """

    bag: str
    people: dict[str, str]
    consents: dict[str, str]


class RunningGames:
    """Folder with the address of each running worker, and with results that no server has used yet.

    A worker holds a lock on the file with its address. The system releases the lock when the worker ends for any
    reason. So a file without a lock belongs to no worker. A worker on another machine has a file without a lock, which
    the server deletes when the worker has ended.

    Args:
        folder: the folder. Only this account may have access to it.

    Raises:
        BadFile: the folder cannot be created, or other accounts have access to it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        remedy = "Remove it, or set TMPDIR to a folder of your own"
        for each in (folder.parent, folder):
            try:
                each.mkdir(mode=0o700, exist_ok=True)
                found = each.lstat()
            except OSError as error:
                raise BadFile(each, f"running games cannot be kept here ({reason_of(error)})", remedy) from None
            if found.st_uid != os.getuid() or found.st_mode & _OTHERS or not each.is_dir() or each.is_symlink():
                raise BadFile(each, "other accounts have access to this folder of running games", remedy)

    @classmethod
    def of(cls, served: Path) -> "RunningGames":
        """Return the running games of a server; `served` is the folder to which it records."""
        # The folder is temporary, because the path of a socket must be short, and no worker survives a restart of the
        # machine.
        digest = hashlib.sha256(os.fsencode(served.resolve())).hexdigest()[:_DIGEST]
        return cls(Path(tempfile.gettempdir(), f"thbridge-serve-{os.getuid()}", digest))

    def lock_server(self, served: Path) -> IO[bytes]:
        """Return an open file that locks the games against other servers; the system unlocks it when they are gone.

        Raises:
            BadFile: another server has locked them.
        """
        file = self._server_lock()
        if not _locked(file, fcntl.LOCK_EX):
            file.close()
            remedy = "Name another folder, or end that server after its games with `thbridge serve --drain`"
            raise BadFile(served, "another server serves this folder", remedy)
        return file

    def await_server(self) -> None:
        """Wait until no server has locked the games."""
        with self._server_lock() as file:
            fcntl.flock(file.fileno(), fcntl.LOCK_SH)

    def _server_lock(self) -> IO[bytes]:
        return open(self.folder / "server.lock", "ab", opener=_for_owner)

    def __iter__(self) -> Iterator[str]:
        """Yield the keys of all running games."""
        for key in sorted({path.stem for ending in (_GAME, _REMOTE) for path in self.folder.glob(f"*{ending}")}):
            if self.is_running(key):
                yield key

    def is_running(self, key: str) -> bool:
        """Return True if a worker plays the game with this key. A worker on another machine may have died meanwhile."""
        if self._remote(key).exists():
            return True
        with suppress(FileNotFoundError), self._record(key).open("rb") as file:
            return not _locked(file, fcntl.LOCK_SH)
        return False

    def address(self, key: str) -> WorkerAddress | None:
        """Return the address of the game's worker; None if it has written none."""
        for path in (self._remote(key), self._record(key)):
            with suppress(FileNotFoundError, msgspec.MsgspecError):
                return msgspec.json.decode(path.read_bytes(), type=WorkerAddress)
        return None

    def remote_host(self, key: str) -> str:
        """Return the other machine on which the game runs; empty if it runs on this machine, or not at all."""
        with suppress(FileNotFoundError, msgspec.MsgspecError):
            return msgspec.json.decode(self._remote(key).read_bytes(), type=WorkerAddress).host
        return ""

    def place_remotely(self, key: str, address: WorkerAddress) -> None:
        """Note that a worker on another machine plays the game."""
        write_whole(self._remote(key), msgspec.json.encode(address), mode=0o600)

    def end_remotely(self, key: str) -> None:
        """Note that the worker on another machine has ended."""
        self._remote(key).unlink(missing_ok=True)

    def claim(self, key: str) -> IO[bytes] | None:
        """Return the locked file for the address of a game's worker; None if the game already has a worker."""
        file = open(self._record(key), "ab", buffering=0, opener=_for_owner)  # noqa: SIM115 - it stays open
        for _ in range(_TRIES):
            if _locked(file, fcntl.LOCK_EX):
                file.truncate(0)
                return file
            time.sleep(_LOOK)  # `is_running` also locks the file for a moment.
        file.close()
        return None

    def socket(self, token: str) -> Path:
        """Return the path of a worker's socket."""
        return self.folder / f"{token[:12]}{_SOCKET}"

    def result(self, key: str) -> WorkerResult | None:
        """Return the result of an ended game; None if there is none, or if it is already used."""
        with suppress(FileNotFoundError, msgspec.MsgspecError):
            return _RESULTS.decode(self._result(key).read_bytes())
        return None

    def keep(self, key: str, result: WorkerResult) -> None:
        """Keep the result of a game until `forget`."""
        write_whole(self._result(key), msgspec.json.encode(result), mode=0o600)

    def history(self, key: str, seat: str = "") -> Path:
        """Return the path of the history of a seat, which the next process of the game continues."""
        return self.folder / f"{key}{f'.{seat}' if seat else ''}{_HISTORY}"

    def forget(self, key: str) -> None:
        """Delete the result, the histories and the people of a game, because the result is in the log."""
        for path in (self._result(key), self.history(key), self._group(key), *self.folder.glob(f"{key}.*{_HISTORY}")):
            path.unlink(missing_ok=True)

    def keep_group(self, key: str, group: GroupRecord) -> None:
        """Keep the people of a game, for the next server."""
        write_whole(self._group(key), msgspec.json.encode(group), mode=0o600)

    def groups(self) -> Iterator[tuple[str, GroupRecord]]:
        """Yield the keys and the people of all games that are running, or whose results are not used yet."""
        for path in self.folder.glob(f"*{_GROUP}"):
            if self.is_running(path.stem) or self._result(path.stem).exists():
                with suppress(msgspec.MsgspecError):
                    yield path.stem, msgspec.json.decode(path.read_bytes(), type=GroupRecord)

    def tidy(self) -> None:
        """Delete the files of workers that have died."""
        living = {each.socket for key in self if (each := self.address(key)) is not None}
        for path in self.folder.glob(f"*{_GAME}"):
            if not self.is_running(path.stem):
                path.unlink(missing_ok=True)
        for path in self.folder.glob(f"*{_SOCKET}"):
            if str(path) not in living:
                path.unlink(missing_ok=True)
        groups = {key for key, _ in self.groups()}
        for path in self.folder.glob(f"*{_GROUP}"):
            if path.stem not in groups:
                self.forget(path.stem)

    def _record(self, key: str) -> Path:
        return self.folder / f"{key}{_GAME}"

    def _remote(self, key: str) -> Path:
        return self.folder / f"{key}{_REMOTE}"

    def _group(self, key: str) -> Path:
        return self.folder / f"{key}{_GROUP}"

    def _result(self, key: str) -> Path:
        return self.folder / f"{key}{_RESULT}"


def _for_owner(path: str, flags: int) -> int:
    return os.open(path, flags | os.O_NOFOLLOW, 0o600)


def _locked(file: IO[bytes], how: int) -> bool:
    """Lock a file; return False if a process has locked it."""
    try:
        fcntl.flock(file.fileno(), how | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
