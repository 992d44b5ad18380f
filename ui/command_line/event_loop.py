"""Event loop that runs a program and, if a person plays, reads the keyboard."""

import asyncio
import os
import sys
from collections.abc import Callable, Coroutine
from contextlib import nullcontext
from typing import TypeVar

from thbridge.timing.loop import stopping
from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail

T = TypeVar("T")

_NO_KEYBOARD = "--participant person: standard input is a file, or is closed. Type in a terminal, or use a pipe."


def run(
    program: Coroutine[object, object, T],
    typed: Callable[[str], None] | None = None,
    *,
    handles_signals: bool = False,
) -> T:
    """Run a program to its end. If `typed` is given, it receives each typed line.

    A signal at any time ends the program like a signal during its loop (see `stopping`), unless `handles_signals` is
    True. If a file is bad, print its message and end the command with the exit code `FAILED`.

    Raises:
        KeyboardInterrupt: a second signal ended the program before or after its loop.
    """
    with bad_input(FAILED):
        try:
            return asyncio.run(_started(program, typed, handles_signals))
        except asyncio.CancelledError:
            raise KeyboardInterrupt from None


async def _started(
    program: Coroutine[object, object, T], typed: Callable[[str], None] | None, handles_signals: bool
) -> T:
    with nullcontext() if handles_signals else stopping():
        return await (program if typed is None else _with_keyboard(program, typed))


async def _with_keyboard(program: Coroutine[object, object, T], typed: Callable[[str], None]) -> T:
    """Run a program, and read typed lines between two ticks."""
    loop = asyncio.get_running_loop()

    def readable() -> None:
        line = sys.stdin.readline()
        if line:
            typed(line)
        else:
            loop.remove_reader(sys.stdin)

    try:
        loop.add_reader(sys.stdin, readable)
    except (OSError, ValueError):
        program.close()
        fail(BAD_INPUT, _NO_KEYBOARD)
    return await program


def read_line() -> str:
    """Wait for one typed line, and read nothing after this line; for use before the event loop runs.

    Return "" at the end of the input.
    """
    line = b""
    try:
        while not line.endswith(b"\n") and (byte := os.read(sys.stdin.fileno(), 1)):
            line += byte
    except (OSError, ValueError):
        fail(BAD_INPUT, _NO_KEYBOARD)
    return line.decode(errors="replace")
