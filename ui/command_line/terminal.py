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
"""The command of this very program."""

FAILED = 1
BAD_INPUT = 2
DECLINED = 3
"""The participant did not agree to take part."""
"""Exit codes; 0 is done."""

NOT_TAKING_PART = "The participant did not agree to take part. Nothing was recorded."
"""The message that goes with `DECLINED`."""


class VisibleConsole(Console):
    """A console that prints names of others as they are, without markup, and their control characters as escapes."""

    def __init__(self, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, markup=False, emoji=False)

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Render an object; colors and cursor are set by segments of their own, or not in the text."""
        for text, style, control in super().render(renderable, options):
            yield Segment(text if control else visible(text, _KEPT), style, control)


_KEPT = "\n\t"
_DISK_FAULTS = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO, errno.EFBIG})
_STANDARD_ERROR = 2
"""Descriptor of the last standard stream."""
_LONGEST_NAME = 200
"""Letters that are shown of the name of a file at fault."""
out = VisibleConsole()
err = VisibleConsole(stderr=True)


def command(*words: object) -> str:
    """A command of ours that a shell takes as it stands, whatever blanks are in a file's name."""
    return shlex.join(["thbridge", *map(str, words)])


def say(text: str) -> None:
    """Print a line as it is, for people and for grep."""
    out.print(visible(text, _KEPT), highlight=False, markup=False, soft_wrap=True)


def show(text: str) -> None:
    """Print a sentence: broken between words on a terminal, in one line for files and other programs."""
    out.print(visible(text, _KEPT), highlight=False, markup=False, soft_wrap=not out.is_terminal)


def note(text: str) -> None:
    """Print a line beside the result, on standard error."""
    err.print(visible(text, _KEPT), highlight=False, markup=False, soft_wrap=True)


def fail(code: int, message: str) -> NoReturn:
    """End the command with the one message that says what to change."""
    err.print(visible(message, _KEPT), style="red", highlight=False, markup=False, soft_wrap=True)
    raise typer.Exit(code)


@contextmanager
def bad_input(code: int = BAD_INPUT) -> Iterator[None]:
    """Report a faulty file in its own words, and end the command."""
    try:
        yield
    except BadFile as fault:
        fail(code, str(fault))


@contextmanager
def faults_of_files() -> Iterator[None]:
    """Report what the system says of a file or a disk, where nobody who knows more about it did, and end the command.

    Errors of sockets name no file, and are not reported.
    """
    try:
        yield
    except MemoryError:
        fail(BAD_INPUT, "There is not enough memory for it. Name a smaller file, or end other programs.")
    except OSError as error:
        if error.filename is None and error.errno not in _DISK_FAULTS and not isinstance(error, shutil.Error):
            raise
        name = "the disk" if error.filename is None else str(error.filename)
        shown = name if len(name) <= _LONGEST_NAME else f"{name[:_LONGEST_NAME]}..."
        fail(BAD_INPUT, f"{shown}: {reason_of(error).lower()}. Check the name, the folder and the disk.")


class _ForgivingFile(io.FileIO):
    """An open file on a disk that may be full, or a pipe that nobody reads: what cannot be written is dropped."""

    def write(self, data: "Buffer", /) -> int:
        """Write bytes, or drop them."""
        try:
            return super().write(data) or 0
        except OSError:
            return memoryview(data).nbytes


def forgive_standard_error() -> None:
    """Go on where messages cannot be written: no hunt ends, and no exit code changes, because its log has no room."""
    usual = sys.stderr
    if usual is not sys.__stderr__ or usual is None:
        return
    with suppress(OSError):
        raw = _ForgivingFile(usual.fileno(), "w", closefd=False)
        sys.stderr = io.TextIOWrapper(io.BufferedWriter(raw), usual.encoding, "backslashreplace", line_buffering=True)


class _ClosedOutput(io.RawIOBase):
    """Standard output that is closed. What is written to it is lost.

    Attributes:
        lost: True once something was written.
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
    """Open the standard streams that are closed: no file of ours takes their place, and lost output is noticed."""
    while (free := os.open(os.devnull, os.O_RDWR)) <= _STANDARD_ERROR:
        os.set_inheritable(free, True)
    os.close(free)
    if sys.stdout is None:
        sys.stdout = io.TextIOWrapper(io.BufferedWriter(_ClosedOutput()), "utf-8")


def escape_for_standard_output() -> None:
    """Write letters that the locale's encoding does not have as escapes, such as \\xb0, instead of an exception."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")


@contextmanager
def whole_standard_output() -> Iterator[None]:
    """See that all of the result is written before the program ends, or say why not; a pipe may end before.

    Raises:
        SystemExit: it cannot be written.
    """
    try:
        with faults_of_files():
            try:
                yield
            except (typer.Exit, SystemExit) as left:
                # What has failed is told already, and it may be that there was no room.
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
    # What is left would be tried again by Python, and told as a fault.
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
        fail(FAILED, "Standard output is closed, and what the command printed is lost. Direct it to a file.")


def print_json(value: Mapping[str, object]) -> None:
    """Print the one object that --json promises, all of standard output."""
    print(json.dumps(value))  # noqa: T201 - no colours, no wrapping
