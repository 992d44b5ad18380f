"""Output, error messages and exit codes of all commands."""

import errno
import io
import json
import os
import shlex
import shutil
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, nullcontext, suppress
from typing import TYPE_CHECKING, NoReturn

import typer
from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment

from thbridge.files.errors import BadFile, reason_of, visible

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer as Buffer

THBRIDGE = (sys.executable, "-c", "from ui.cli import main; main()")
"""Command that runs this program."""

FAILED = 1
BAD_INPUT = 2
DECLINED = 3
"""Exit code if the participant did not agree to take part."""
"""Exit codes; 0 means success."""

NOT_TAKING_PART = "The participant did not agree to take part. Nothing was recorded."
"""Error message for the exit code `DECLINED`."""


class VisibleConsole(Console):
    """Console for untrusted text: it ignores markup, and prints control characters as escapes."""

    def __init__(self, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, markup=False, emoji=False)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Render an object. Colors and cursor movements are separate segments, so only text is escaped."""
        for text, style, control in super().render(renderable, options):
            yield Segment(text if control else visible(text, _KEPT), style, control)


_KEPT = "\n\t"
_DISK_FAULTS = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO, errno.EFBIG})
_STANDARD_ERROR = 2
"""File descriptor of standard error, the last standard stream."""
_LONGEST_NAME = 200
"""Maximum number of characters of a bad file's name that an error message shows."""
out = VisibleConsole()
err = VisibleConsole(stderr=True)


def command(*words: object) -> str:
    """Return a `thbridge` command that can be pasted into a shell, even if a file name has blanks."""
    return shlex.join(["thbridge", *map(str, words)])


def say(text: str) -> None:
    """Print a line without wrapping, so that people can read it and grep can search it."""
    out.print(visible(text, _KEPT), highlight=False, markup=False, soft_wrap=True)


def show(text: str) -> None:
    """Print a sentence. A terminal wraps it between words; files and other programs receive one line."""
    out.print(visible(text, _KEPT), highlight=False, markup=False, soft_wrap=not out.is_terminal)


def note(text: str) -> None:
    """Print a line on standard error, so that it is not part of the result."""
    err.print(visible(text, _KEPT), highlight=False, markup=False, soft_wrap=True)


def fail(code: int, message: str) -> NoReturn:
    """Print an error message and end the command."""
    err.print(visible(message, _KEPT), style="red", highlight=False, markup=False, soft_wrap=True)
    raise typer.Exit(code)


@contextmanager
def bad_input(code: int = BAD_INPUT) -> Iterator[None]:
    """Print the message about a bad file, and end the command."""
    try:
        yield
    except BadFile as fault:
        fail(code, str(fault))


@contextmanager
def faults_of_files() -> Iterator[None]:
    """Report errors of files and disks that no other code has reported, and end the command.

    Errors of sockets name no file. They are raised again.
    """
    try:
        yield
    except MemoryError:
        fail(BAD_INPUT, "Not enough memory. Use a smaller file, or close other programs.")
    except OSError as error:
        if error.filename is None and error.errno not in _DISK_FAULTS and not isinstance(error, shutil.Error):
            raise
        name = "the disk" if error.filename is None else str(error.filename)
        shown = name if len(name) <= _LONGEST_NAME else f"{name[:_LONGEST_NAME]}..."
        fail(BAD_INPUT, f"{shown}: {reason_of(error).lower()}. Check the name, the folder and the disk.")


class _ForgivingFile(io.FileIO):
    """File that may be on a full disk, or a pipe without a reader. It drops bytes that cannot be written."""

    def write(self, data: "Buffer", /) -> int:
        """Write bytes; drop them if they cannot be written."""
        try:
            return super().write(data) or 0
        except OSError:
            return memoryview(data).nbytes


def forgive_standard_error() -> None:
    """Ignore errors of writing messages, so that a full disk does not end a hunt or change an exit code."""
    usual = sys.stderr
    if usual is not sys.__stderr__ or usual is None:
        return
    with suppress(OSError):
        raw = _ForgivingFile(usual.fileno(), "w", closefd=False)
        sys.stderr = io.TextIOWrapper(io.BufferedWriter(raw), usual.encoding, "backslashreplace", line_buffering=True)


class _ClosedOutput(io.RawIOBase):
    """Substitute for a closed standard output. It drops all bytes.

    Attributes:
        lost: True after something was written.
    """

    lost = False

    def writable(self) -> bool:
        """Return True."""
        return True

    def write(self, data: "Buffer", /) -> int:
        """Drop bytes."""
        self.lost = True
        return memoryview(data).nbytes


def replace_closed_streams() -> None:
    """Open standard streams that are closed.

    Otherwise, later files would get the numbers of these streams, and lost output would not be noticed.
    """
    while (free := os.open(os.devnull, os.O_RDWR)) <= _STANDARD_ERROR:
        os.set_inheritable(free, True)
    os.close(free)
    if sys.stdout is None:
        sys.stdout = io.TextIOWrapper(io.BufferedWriter(_ClosedOutput()), "utf-8")


def escape_for_standard_output() -> None:
    """Write escapes, such as \\xb0, for characters that the locale's encoding does not contain."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


@contextmanager
def whole_standard_output() -> Iterator[None]:
    """Write the complete result before the program ends, or report why this failed.

    If the reader of a pipe ends earlier, print no message, and exit with the code `FAILED`.

    Raises:
        SystemExit: the result cannot be written.
    """
    try:
        with faults_of_files():
            try:
                yield
            except (typer.Exit, SystemExit) as left:
                # The failure has already been reported, and its cause may have been a full disk.
                with suppress(OSError, typer.Exit) if _code_of(left) else nullcontext():
                    _flush()
                raise
            _flush()
    except BrokenPipeError:
        code = FAILED
    except (typer.Exit, SystemExit) as failed:
        code = _code_of(failed)
    else:
        return
    # Python would try to write the rest again at exit, and report a fault.
    with suppress(OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, sys.stdout.fileno())
        os.close(nowhere)
    sys.exit(code)


def _code_of(left: typer.Exit | SystemExit) -> int:
    code = left.exit_code if isinstance(left, typer.Exit) else left.code
    return code if isinstance(code, int) else 0 if code is None else FAILED


def _flush() -> None:
    sys.stdout.flush()
    raw = getattr(getattr(sys.stdout, "buffer", None), "raw", None)
    if isinstance(raw, _ClosedOutput) and raw.lost:
        fail(FAILED, "Standard output is closed, so the output of this command is lost. Redirect it to a file.")


def print_json(value: Mapping[str, object]) -> None:
    """Print the JSON object of --json; a command prints nothing else on standard output."""
    print(json.dumps(value))  # noqa: T201 - no colors, no wrapping
