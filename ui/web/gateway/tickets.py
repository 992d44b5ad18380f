"""Record of browsers and their participants, so that people find their place again after a restart."""

import hashlib
import json
from pathlib import Path

from thbridge.files.disk.json_files import read_json
from thbridge.files.disk.whole import write_whole

_REMEDY = "Move it away; people who are in the study then begin again"


class Tickets:
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
        self._participants[_digest(secret)] = participant
        write_whole(self._path, json.dumps(self._participants, indent=1).encode())


def _digest(secret: str) -> str:
    return hashlib.sha256(secret.encode()).hexdigest()
