"""Sleeping copies of a worker, which share its memory. If the worker is killed, its latest copy continues the game."""

import asyncio
import fcntl
import os
import signal
import socket
import stat
from collections.abc import Callable, Collection
from contextlib import suppress
from pathlib import Path
from typing import IO

_DROPPED = b"d"
_DEFERRED = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
"""Signals that a sleeping copy receives when it wakes. Python would pass them on to the process that is copied."""


class SleepingCopies:
    """Copies of this process, one at a time; see `thbridge.app.play.Checkpoints`.

    A copy waits for the end of a pipe that only this process has open for writing.

    Args:
        record: file of the worker. A copy that wakes locks it, so that only one copy continues.
        woke: called first in a copy that wakes.
    """

    def __init__(self, record: IO[bytes], woke: Callable[[], None]) -> None:
        self._record = record
        self._woke = woke
        self._pulse: int | None = None
        self._ended: list[int] = []
        self._copy = 0

    def take(self) -> bool:
        """Make a copy of this process, and end the earlier copy; return True in a copy that wakes."""
        loop = asyncio.get_running_loop()
        alive, pulse = os.pipe()
        signal.pthread_sigmask(signal.SIG_BLOCK, _DEFERRED)
        wakeup = signal.set_wakeup_fd(-1)
        copy = os.fork()
        if copy == 0:
            os.close(pulse)
            if self._pulse is not None:
                os.close(self._pulse)
            self._sleep(alive)
            # Python does not expect that a process and its copy use the same event loop one after the other.
            asyncio._set_running_loop(loop)
        signal.set_wakeup_fd(wakeup, warn_on_full_buffer=False)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _DEFERRED)
        if copy == 0:
            self._woke()
            return True
        os.close(alive)
        self.drop()
        self._pulse, self._copy = pulse, copy
        return False

    def drop(self) -> None:
        """End the copy."""
        if self._pulse is not None:
            with suppress(BrokenPipeError):
                os.write(self._pulse, _DROPPED)
            os.close(self._pulse)
            self._pulse = None
            self._ended.append(self._copy)
        # A copy needs a moment to end; the system keeps its entry until it is collected.
        self._ended = [copy for copy in self._ended if os.waitpid(copy, os.WNOHANG) == (0, 0)]

    def _sleep(self, alive: int) -> None:
        """Wait until the process has died. If the copy is not needed, end it."""
        is_dropped = os.read(alive, 1) == _DROPPED
        os.close(alive)
        try:
            # This lock belongs to one process, unlike the lock that all copies of the worker share.
            fcntl.lockf(self._record, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            is_dropped = True
        if is_dropped:
            os._exit(0)
        self._pulse, self._ended = None, []


def shut_accepted(places: Collection[str | int]) -> None:
    """Shut down all connections that were accepted at listening sockets, for a copy that wakes.

    Args:
        places: places of the sockets, as `place_of` returns them.

    The process that was killed has read from them. The copy, and copies of the copy, still have them open, also those
    that the event loop has just accepted. So the other side would never find out that the process was killed.
    """
    for entry in Path("/proc/self/fd").iterdir():
        with suppress(OSError):
            if not stat.S_ISSOCK(entry.stat().st_mode):
                continue
            with socket.socket(fileno=os.dup(int(entry.name))) as each:
                is_accepted = not each.getsockopt(socket.SOL_SOCKET, socket.SO_ACCEPTCONN)
                if is_accepted and place_of(each) in places:
                    each.shutdown(socket.SHUT_RDWR)


def place_of(listening: socket.socket) -> str | int:
    """Return the path of a socket, or its port: a socket that listens on all addresses has another host."""
    name: str | tuple[str, int] = listening.getsockname()
    return name[1] if isinstance(name, tuple) else name
