"""Exception and warning of the public interface, and the conversion of internal exceptions."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from thbridge.files.errors import BadFile, reason_of


class HuntError(Exception):
    """Error that the caller can correct: in a study, a recording, an argument or a request.

    `str(error)` has one line for each problem, with the location (file, line, key), the problem and the remedy.

    Attributes:
        file: the file or folder with the problem, or None.
        line: line number in this file, from 1, or None.
        key: the key with the problem, such as "robot.amcl.max_particles", or None.
    """

    def __init__(self, message: str, file: Path | None = None, line: int | None = None, key: str | None = None) -> None:
        super().__init__(message)
        self.file = file
        self.line = line
        self.key = key


class HuntWarning(UserWarning):
    """Warning about a probable mistake in a valid study, with location, problem and remedy."""


@contextmanager
def as_hunt_errors() -> Iterator[None]:
    """Raise `HuntError` for bad files and for errors of the operating system."""
    try:
        yield
    except BadFile as fault:
        raise HuntError(str(fault), fault.path, fault.line, fault.key) from None
    except OSError as error:
        where = "" if error.filename is None else f"{error.filename}: "
        raise HuntError(f"{where}{reason_of(error)}. Choose another path, or free disk space.") from None
