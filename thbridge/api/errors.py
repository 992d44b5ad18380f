"""The exception of this interface, and the conversion of the program's own ones to it."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from thbridge.files.errors import BadFile, reason_of


class HuntError(Exception):
    """Something that a caller can mend: a study, a recording, an argument, a request.

    `str()` of it says where (file, line, key), what is wrong, and the remedy; one line for each fault.

    Attributes:
        file: the file or folder at fault, or None.
        line: its line, from 1, or None.
        key: the key at fault, such as "robot.amcl.max_particles", or None.
    """

    def __init__(self, message: str, file: Path | None = None, line: int | None = None, key: str | None = None) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.key = key


class HuntWarning(UserWarning):
    """Something in a study that is allowed, but looks like a slip: where, what, and the remedy."""


@contextmanager
def told() -> Iterator[None]:
    """Raise faults of files within as `HuntError`."""
    try:
        yield
    except BadFile as fault:
        raise HuntError(str(fault), fault.path, fault.line, fault.key) from None
    except OSError as error:
        where = "" if error.filename is None else f"{error.filename}: "
        raise HuntError(f"{where}{reason_of(error)}. Choose another place, or make room.") from None
