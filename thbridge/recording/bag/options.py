"""Options of a recording: choice of messages, compression of chunks, and limits of a file."""

from dataclasses import dataclass
from enum import StrEnum


class Compression(StrEnum):
    """Compression of the chunks of a recording."""

    NONE = "none"
    LZ4 = "lz4"
    BZ2 = "bz2"
    ZSTD = "zstd"


ROS1_COMPRESSIONS = (Compression.NONE, Compression.LZ4, Compression.BZ2)
"""Compressions that bags of ROS 1 can have."""
MCAP_COMPRESSIONS = (Compression.NONE, Compression.LZ4, Compression.ZSTD)
"""Compressions that MCAP files can have."""


class RecordingFormat(StrEnum):
    """Format of recordings. The value is the ending of their names."""

    BAG = "bag"
    MCAP = "mcap"

    @property
    def compressions(self) -> tuple[Compression, ...]:
        """Compressions that recordings of this format can have."""
        return ROS1_COMPRESSIONS if self is RecordingFormat.BAG else MCAP_COMPRESSIONS


class RecordingDetail(StrEnum):
    """Messages of a session that are recorded."""

    CHANGES = "changes"
    ALL = "all"


class DefinitionTexts(StrEnum):
    """Texts of the message definitions in a bag."""

    OWN = "own"
    INSTALLED = "installed"


@dataclass(frozen=True, slots=True)
class SplitLimits:
    """Limits of a file, after which a recording continues in another file.

    Attributes:
        size: bytes after which a file ends. If None, there is no limit. A file always ends with a complete chunk, and
            never between messages with equal stamps. Latched messages that are repeated at the beginning of a file do
            not count, because they alone may exceed the limit.
        duration_ns: longest recorded time of a file. If None, there is no limit.
    """

    size: int | None = None
    duration_ns: int | None = None

    @property
    def wanted(self) -> bool:
        """True if there is a limit; a recording may then have several files."""
        return self.size is not None or self.duration_ns is not None


class Readers(StrEnum):
    """Accounts of the machine that may read written files."""

    OWNER = "owner"
    GROUP = "group"
    EVERYONE = "everyone"

    @property
    def umask(self) -> int:
        """Permissions that are removed from new files and folders."""
        return {Readers.OWNER: 0o077, Readers.GROUP: 0o027, Readers.EVERYONE: 0o022}[self]
