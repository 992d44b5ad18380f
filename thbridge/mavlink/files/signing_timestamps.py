"""Timestamps of accepted frames, in a file next to the signing key.

With these timestamps, no frame is accepted a second time after a restart.
"""

import json
import logging
from pathlib import Path

from thbridge.files.disk.whole import write_whole
from thbridge.files.errors import BadFile
from thbridge.mavlink.wire.frames.signing import MAX_STREAMS, KnownTimestamps

SUFFIX = ".timestamps"
"""Suffix that is appended to the name of the key file."""

_FORMAT = "thbridge signing timestamps 1"
_LARGEST = 1 << 20

_log = logging.getLogger(__name__)


class TimestampFile:
    """File of timestamps.

    Args:
        key: file of the signing key.
        side: suffix for the program at this end of the link: empty for the robots. Each program has its own file.
    """

    def __init__(self, key: Path, side: str = "") -> None:
        self._path = key.with_name(key.name + side + SUFFIX)
        self._has_failed = False

    def read(self) -> KnownTimestamps | None:
        """Return the timestamps, or None if the file is missing or damaged."""
        try:
            with self._path.open("rb") as file:
                return _known(json.loads(file.read(_LARGEST)))
        except FileNotFoundError:
            return None
        except (OSError, ValueError, RecursionError) as error:
            _log.warning("%s cannot be used (%s): only frames signed from now on will be accepted", self._path, error)
            return None

    def write(self, known: KnownTimestamps) -> None:
        """Replace the file. Only its owner can read it. A failure is logged once."""
        streams = [[*stream, timestamp] for stream, timestamp in sorted(known.streams.items())]
        text = json.dumps({"format": _FORMAT, "latest": known.latest, "streams": streams})
        try:
            write_whole(
                self._path,
                text.encode(),
                "free disk space, because stations may be refused after a restart",
                mode=0o600,
            )
        except BadFile as fault:
            if not self._has_failed:
                _log.warning("%s", fault)
            self._has_failed = True


def _known(read: object) -> KnownTimestamps:
    match read:
        case {"format": str(named), "latest": int(latest), "streams": list(rows)} if named == _FORMAT:
            streams: dict[tuple[int, int, int], int] = {}
            for row in rows:
                match row:
                    case [int(link), int(system), int(component), int(timestamp)] if timestamp <= latest:
                        streams[link, system, component] = timestamp
                    case _:
                        raise ValueError("a row is not a timestamp")
            if 0 <= latest < 1 << 48 and len(streams) <= MAX_STREAMS:
                return KnownTimestamps(latest, streams)
    raise ValueError("it is not a file of timestamps")
