"""Options of a recording: which messages, how chunks are compressed, and when another file begins."""

from dataclasses import dataclass
from enum import StrEnum


class Compression(StrEnum):
    """Compression of the chunks of a bag."""

    NONE = "none"
    LZ4 = "lz4"
    BZ2 = "bz2"


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
    """Limits of a file, after which a recording goes on in another one.

    Attributes:
        size: bytes after which a file ends, behind a chunk and all messages of one stamp; None for no limit.
            Latched messages repeated at a file's beginning do not count: they alone may be larger.
        duration_ns: longest recorded time of a file; None for no limit.
    """

    size: int | None = None
    duration_ns: int | None = None

    @property
    def wanted(self) -> bool:
        """True when there is a limit, so that there may be several files."""
        return self.size is not None or self.duration_ns is not None


class Readers(StrEnum):
    """Accounts of the machine that may read what is written."""

    OWNER = "owner"
    GROUP = "group"
    EVERYONE = "everyone"

    @property
    def umask(self) -> int:
        """The permissions that new files and folders do not get."""
        return {Readers.OWNER: 0o077, Readers.GROUP: 0o027, Readers.EVERYONE: 0o022}[self]
