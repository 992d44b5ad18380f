"""Event loop that runs a program and, if a person plays, reads the keyboard."""

import asyncio
import os
import sys
from collections.abc import Callable, Coroutine
from typing import TypeVar

from ui.command_line.terminal import BAD_INPUT, FAILED, bad_input, fail

T = TypeVar("T")

_NO_KEYBOARD = "--participant person: standard input is a file or closed. Type in a terminal, or use a pipe."


def run(program: Coroutine[object, object, T], typed: Callable[[str], None] | None = None) -> T:
    """Run a program to its end; `typed`, if given, receives each typed line. A bad file ends the command as failed."""
    with bad_input(FAILED):
        return asyncio.run(_with_keyboard(program, typed))


async def _with_keyboard(program: Coroutine[object, object, T], typed: Callable[[str], None] | None) -> T:
    """Run a program; typed lines are read between two ticks."""
    if typed is None:
        return await program
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
    """Wait for one typed line before the event loop runs, and read nothing after it.

    Return "" at the end of the input.
    """
    line = b""
    try:
        while not line.endswith(b"\n") and (byte := os.read(sys.stdin.fileno(), 1)):
            line += byte
    except (OSError, ValueError):
        fail(BAD_INPUT, _NO_KEYBOARD)
    return line.decode(errors="replace")
