"""Withdrawals that have begun and are not finished, and the digests of events that withdrawals deleted."""

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from thbridge.files.disk.json_files import read_json
from thbridge.files.disk.synced import sync_folder
from thbridge.files.disk.whole import clear_parts, write_whole
from thbridge.files.errors import BadFile, reason_of

_DAMAGE = "is damaged: it lists withdrawals"
_REMEDY = "Check who withdrew in it, move it away, and withdraw them again with `thbridge study withdraw`"
_MOST_BYTES = 1 << 26
"""Largest list in bytes; the digest of an event takes 68."""


@dataclass(frozen=True, slots=True)
class PendingWithdrawal:
    """A withdrawal that has begun.

    Attributes:
        participant: id of the participant.
        code: their completion code; empty if there is none.
    """

    participant: str
    code: str = ""


class PendingWithdrawals:
    """The list of withdrawals that have begun, in a file that exists only while there are some.

    The list is on the disk before anything is deleted, and is deleted when nothing is left to do.

    Args:
        path: path of the file.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    def read(self) -> tuple[PendingWithdrawal, ...]:
        """Return all withdrawals in the list.

        Raises:
            BadFile: the file cannot be read.
        """
        return tuple(read_json(self._path, list[PendingWithdrawal], _DAMAGE, _REMEDY) or ())

    def add(self, withdrawal: PendingWithdrawal) -> None:
        """Add a withdrawal before anything is deleted.

        Raises:
            BadFile: the file cannot be read or written; nothing is added.
        """
        pending = self.read()
        if withdrawal not in pending:
            _write(self._path, [asdict(one) for one in (*pending, withdrawal)])

    def remove(self, withdrawal: PendingWithdrawal) -> None:
        """Remove a finished withdrawal.

        Raises:
            BadFile: the file cannot be read or written.
        """
        left = [asdict(one) for one in self.read() if one != withdrawal]
        try:
            # A program that was killed while writing the list has left a part of it, with the participant's id.
            clear_parts(self._path)
            if left:
                _write(self._path, left)
                return
            self._path.unlink(missing_ok=True)
            sync_folder(self._path.parent)
        except OSError as error:
            problem = f"it cannot be deleted ({reason_of(error)})"
            raise BadFile(self._path, problem, "Give the right to write its folder") from None


class WithdrawnEvents:
    """Digests of all events that withdrawals deleted, in a file without names of people.

    A restored log is an older one, which may still have these events.

    Args:
        path: path of the file, which need not exist.
    """

    def __init__(self, path: Path) -> None:
        self._path = path

    def read(self) -> frozenset[bytes]:
        """Return all digests.

        Raises:
            BadFile: the file cannot be read.
        """
        try:
            return frozenset(map(bytes.fromhex, read_json(self._path, list[str], _DAMAGE, _REMEDY, _MOST_BYTES) or ()))
        except ValueError:
            raise BadFile(self._path, _DAMAGE, _REMEDY) from None

    def add(self, digests: Iterable[bytes]) -> None:
        """Add digests.

        Raises:
            BadFile: the file cannot be read or written.
        """
        known = self.read()
        if not known.issuperset(digests):
            _write(self._path, sorted(digest.hex() for digest in known.union(digests)))


def _write(path: Path, content: list[object] | list[dict[str, str]] | list[str]) -> None:
    write_whole(path, (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode())
