"""A temporary file for data that would not fit into memory."""

from pathlib import Path
from tempfile import TemporaryFile
from typing import BinaryIO


class SpoolFile:
    """A temporary file without a name, created when it is needed, and deleted with this object.

    Args:
        folder: folder for the file. If None, the system's folder for temporary files is used.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder
        self._file: BinaryIO | None = None

    def put(self, data: bytes | memoryview) -> tuple[int, int]:
        """Append bytes. Return the offset and the number of these bytes. Raises OSError if the disk is full."""
        if self._file is None:
            self._file = TemporaryFile(prefix="thbridge-", dir=self._folder)  # noqa: SIM115
        at = self._file.seek(0, 2)
        self._file.write(data)
        return at, len(data)

    def get(self, at: int, size: int) -> bytes:
        """Return the bytes at an offset."""
        if self._file is None:
            return b""
        self._file.seek(at)
        return self._file.read(size)
