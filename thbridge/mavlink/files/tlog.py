"""Writer of a telemetry log (MAVLink tlog) that is complete after every tick."""

from collections.abc import Iterable
from pathlib import Path
from typing import Self

from thbridge.files.errors import BadFile, reason_of
from thbridge.mavlink.wire.tlog import Tlog
from thbridge.mavlink.wire.traffic import Traffic
from thbridge.recording.append import append_whole


class TlogFile:
    """File to which frames are appended. Close it, or use it in `with`.

    Args:
        path: path of the file.

    Raises:
        BadFile: the file already exists or cannot be written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._tlog = Tlog()
        try:
            # Unbuffered, so that a killed program loses no complete tick.
            self._file = path.open("xb", buffering=0)
        except FileExistsError:
            remedy = "choose another name, or move this file to another folder"
            raise BadFile(path, "this file already exists", remedy) from None
        except OSError as error:
            raise _not_writable(path, error, "name a folder that exists and is writable") from None

    def record(self, stamp_ns: int, traffic: Iterable[Traffic]) -> None:
        """Write the frames that vehicles received and sent in a tick.

        Raises:
            BadFile: the disk is full or missing. The file contains all earlier ticks.
        """
        records = self._tlog.records(stamp_ns // 1000, traffic)
        try:
            append_whole(self._file, records, synced=False)
        except OSError as error:
            raise _not_writable(self.path, error, "free disk space; the file contains all earlier ticks") from None

    def close(self) -> None:
        """Close the file. Closing twice does nothing."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _not_writable(path: Path, error: OSError, remedy: str) -> BadFile:
    return BadFile(path, f"the telemetry log cannot be written ({reason_of(error)})", remedy)
