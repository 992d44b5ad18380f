"""Signals that end a command: SIGTERM and SIGHUP (end of the terminal) are handled like Ctrl-C."""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

INTERRUPTED = 130
"""Exit code of a command that Ctrl-C ended before or after its loop."""


@contextmanager
def ended_like_ctrl_c() -> Iterator[None]:
    """Raise KeyboardInterrupt in the block for SIGTERM and SIGHUP as well, so that a command closes its files.

    If such a signal ended the block, the process then dies of this signal, as its parent expects. A SIGHUP that the
    process ignores (nohup) stays ignored.
    """
    received: list[int] = []

    def interrupt(number: int, _frame: FrameType | None) -> None:
        received.append(number)
        signal.raise_signal(signal.SIGINT)

    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, interrupt)
    try:
        yield
    except SystemExit as ended:
        if received and ended.code == INTERRUPTED:
            sys.stdout.flush()
            signal.signal(received[0], signal.SIG_DFL)
            os.kill(os.getpid(), received[0])
        raise
