"""Writes a telemetry log (MAVLink tlog), which is complete after every tick."""

from collections.abc import Iterable
from pathlib import Path
from typing import Self

from thbridge.files.errors import BadFile, reason_of
from thbridge.mavlink.wire.tlog import Tlog
from thbridge.mavlink.wire.traffic import Traffic
from thbridge.recording.append import append_whole


class TlogFile:
    """Appends frames to a new file. Close it, or use it in `with`.

    Args:
        path: path of the file.

    Raises:
        BadFile: the file exists already, or it cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._tlog = Tlog()
        try:
            self._file = path.open("xb", buffering=0)
        except FileExistsError:
            remedy = "choose another name, or move it elsewhere"
            raise BadFile(path, "there is such a file already", remedy) from None
        except OSError as error:
            raise _not_writable(path, error, "name a folder that exists and may be written to") from None

    def record(self, stamp_ns: int, traffic: Iterable[Traffic]) -> None:
        """Write the frames that vehicles received and sent in a tick.

        Raises:
            BadFile: the disk is full or gone; all ticks before are in the file.
        """
        records = self._tlog.records(stamp_ns // 1000, traffic)
        try:
            append_whole(self._file, records, synced=False)
        except OSError as error:
            raise _not_writable(self.path, error, "make room; it holds all ticks before") from None

    def close(self) -> None:
        """Close the file. Closing twice does nothing."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _not_writable(path: Path, error: OSError, remedy: str) -> BadFile:
    return BadFile(path, f"the telemetry log cannot be written ({reason_of(error)})", remedy)
