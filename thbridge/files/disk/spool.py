"""A temporary file for what would not fit into memory."""

from pathlib import Path
from tempfile import TemporaryFile
from typing import BinaryIO


class SpoolFile:
    """A temporary file without a name, made when it is needed; it is gone with this object.

    Args:
        folder: where it is made; None for the system's own place.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder
        self._file: BinaryIO | None = None

    def put(self, data: bytes | memoryview) -> tuple[int, int]:
        """Append bytes. Return their offset and number. Raises OSError: the disk is full."""
        if self._file is None:
            self._file = TemporaryFile(prefix="thbridge-", dir=self._folder)  # noqa: SIM115
        at = self._file.seek(0, 2)
        self._file.write(data)
        return at, len(data)

    def get(self, at: int, size: int) -> bytes:
        """The bytes at an offset."""
        if self._file is None:
            return b""
        self._file.seek(at)
        return self._file.read(size)
