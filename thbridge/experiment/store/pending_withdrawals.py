"""Unfinished withdrawals, and the digests of events and link codes that withdrawals deleted."""

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path

from thbridge.files.disk.json_files import read_json
from thbridge.files.disk.synced import sync_folder
from thbridge.files.disk.whole import clear_parts, write_whole
from thbridge.files.errors import BadFile, reason_of

_DAMAGE = "this list of withdrawals is damaged"
_REMEDY = "Find the participants in it, move the file away, and run `thbridge study withdraw` for each participant"
_MOST_BYTES = 1 << 26
"""Largest size of a list, in bytes. A digest takes 68 bytes."""


@dataclass(frozen=True, slots=True)
class PendingWithdrawal:
    """A withdrawal that was started and is not finished.

    Attributes:
        participant: id of the participant.
        code: the participant's completion code; empty if there is none.
        link: digest of the code in the participant's link, hexadecimal; empty if the study needs no code.
    """

    participant: str
    code: str = ""
    link: str = ""


class PendingWithdrawals:
    """List of unfinished withdrawals in a file. The file exists only if the list is not empty.

    A withdrawal is added to the file before its deletions start, and removed after all of them are done.

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
            BadFile: the file cannot be read or written. The withdrawal is not added.
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
            # A killed program may have left an unfinished list with the participant's id.
            clear_parts(self._path)
            if left:
                _write(self._path, left)
                return
            self._path.unlink(missing_ok=True)
            sync_folder(self._path.parent)
        except OSError as error:
            problem = f"the file cannot be deleted ({reason_of(error)})"
            raise BadFile(self._path, problem, "Give your account the right to write into this folder") from None


class WithdrawnDigests:
    """List of the digests of all events, or of all link codes, that withdrawals deleted; it names no person.

    After a restore, the log is older and may contain the events again.

    Args:
        path: path of the file. The file may not exist.
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
