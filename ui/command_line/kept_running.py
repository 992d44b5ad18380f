"""Restart of a server that dies unexpectedly.

A small process starts the server as its child, and keeps the listening socket open meanwhile, so that no client finds
the port closed.
"""

import os
import signal
import threading
import time
from types import FrameType

import typer

from ui.command_line.terminal import FAILED, fail, note

MOST_DEATHS, WITHIN = 30, 60.0
"""Number of deaths within this number of seconds after which the server is not started again."""
_STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def keep_running() -> bool:
    """Continue this program in a child process; if a signal kills it, continue in another child.

    Return True in the first child.

    The parent process never returns: it waits for the child, and exits with its exit code. SIGTERM is passed on to the
    child. The child dies with the parent.

    Raises:
        typer.Exit: in the parent, after the child has ended.
    """
    deaths: list[float] = []
    while True:
        alive, pulse = os.pipe()
        signal.pthread_sigmask(signal.SIG_BLOCK, _STOPS)  # Until both processes can handle them.
        child = os.fork()
        if child == 0:
            os.close(pulse)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPS)
            threading.Thread(target=_die_with_parent, args=(alive,), daemon=True).start()
            return not deaths
        os.close(alive)
        code = os.waitstatus_to_exitcode(_ended(child))
        os.close(pulse)
        if code >= 0:
            raise typer.Exit(code)
        if -code in _STOPS:
            signal.signal(-code, signal.SIG_DFL)
            os.kill(os.getpid(), -code)
        now = time.monotonic()
        deaths = [*(at for at in deaths if now - at < WITHIN), now]
        if len(deaths) == MOST_DEATHS:
            fail(FAILED, f"The server has died {MOST_DEATHS} times. `thbridge doctor` checks this machine.")
        note(f"The server was ended by {signal.Signals(-code).name}. It is started again; games go on.")


def _ended(child: int) -> int:
    """Wait for a child; return its status. Ctrl-C and the end of the terminal are for the child alone."""

    def pass_on(number: int, _frame: FrameType | None) -> None:
        os.kill(child, number)

    before = {number: signal.getsignal(number) for number in _STOPS}
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, pass_on)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPS)
    try:
        return os.waitpid(child, 0)[1]
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _die_with_parent(alive: int) -> None:
    os.read(alive, 1)
    os._exit(FAILED)
