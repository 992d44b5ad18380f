"""Programs of others that crash: a fault of theirs skips the test and shows the reason, a plain exit status does not.

A crash is an end by a signal that the test did not send. Programs report a fault in our files by an exit status.
"""

import signal
import subprocess
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Protocol

import pytest

ATTEMPTS = 4
"""Starts of a program that crashes before the test is skipped."""
SETTLING = 1.0
"""Seconds that a program which has just closed its connections gets to end."""


class _Process(Protocol):
    def poll(self) -> int | None: ...
    def wait(self, timeout: float) -> int: ...


def skip_if_crashed(program: str, status: int | None, output: str = "") -> None:
    """Skip the test if the program's exit status names a signal; `output` is what it printed."""
    if status is not None and status < 0:
        last = output.strip().rpartition("\n")[2]
        pytest.skip(f"{program} crashed: {signal.Signals(-status).name}{last and f' ({last})'}")


def run_peer(command: Sequence[str | Path], **options: Any) -> subprocess.CompletedProcess[str]:
    """Run a program of others, with options of `subprocess.run`, and skip the test if it crashes."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    skip_if_crashed(str(command[0]), done.returncode, done.stderr)
    return done


@contextmanager
def skipping_if_crashed(program: str, process: _Process) -> Iterator[None]:
    """Skip the test if its body fails and the program has crashed."""
    try:
        yield
    except BaseException:  # pytest's own failures are no Exception.
        with suppress(subprocess.TimeoutExpired):
            process.wait(SETTLING)
        skip_if_crashed(program, process.poll())
        raise


class RestartedPeer:
    """A program that is started again whenever it crashes, up to `ATTEMPTS` starts.

    Args:
        name: of the program, for the reason.
        start: starts it.
        output: what it has printed since its last start.
    """

    def __init__(self, name: str, start: Callable[[], _Process], output: Callable[[], str]) -> None:
        self._name = name
        self._start = start
        self._output = output
        self._starts = 1
        self._process = start()

    def keep_running(self) -> None:
        """Start the program again if it crashed; skip the test at its last crash, and fail at any other end."""
        status = self._process.poll()
        if status is None:
            return
        assert status < 0, f"{self._name} ended with exit status {status}\n{self._output()}"
        if self._starts == ATTEMPTS:
            skip_if_crashed(f"{self._name}, started {ATTEMPTS} times,", status, self._output())
        self._starts += 1
        self._process = self._start()
