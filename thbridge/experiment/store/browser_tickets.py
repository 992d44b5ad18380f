"""Record of browsers and their participants, so that people find their place again after a restart."""

import hashlib
import json
from pathlib import Path

from thbridge.files.disk.json_files import read_json
from thbridge.files.disk.whole import write_whole

_REMEDY = "Move it away; people who are in the study then begin again"


class BrowserTickets:
    """Record in a file; it contains digests of the browsers' secrets, so that it lets no one enter.

    Args:
        path: the file; it need not exist.

    Raises:
        BadFile: the file is damaged.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._participants = read_json(path, dict[str, str], "not a record of browsers", _REMEDY) or {}

    def participant(self, secret: str) -> str:
        """Return the id of the participant with this secret; empty if it is unknown."""
        return self._participants.get(_digest(secret), "")

    def keep(self, secret: str, participant: str) -> None:
        """Record that this secret belongs to a participant."""
        if self.participant(secret) != participant:
            self._participants[_digest(secret)] = participant
            self._write()

    def forget(self, participant: str) -> None:
        """Delete all entries of a participant."""
        kept = {digest: other for digest, other in self._participants.items() if other != participant}
        if len(kept) < len(self._participants):
            self._participants = kept
            self._write()

    def _write(self) -> None:
        write_whole(self._path, json.dumps(self._participants, indent=1).encode())


def _digest(secret: str) -> str:
    return hashlib.sha256(secret.encode()).hexdigest()
