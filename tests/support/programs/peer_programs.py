"""Other projects' programs that may crash: a crash skips the test and shows the reason; an exit status does not.

A program has crashed if it was ended by a signal that the test did not send. Programs report faults in our files by an
exit status.
"""

import signal
import subprocess
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Protocol

import pytest

ATTEMPTS = 4
"""Number of times that a crashing program is started before the test is skipped."""
SETTLING = 1.0
"""Seconds that a program has to end after it has closed its connections."""


class _Process(Protocol):
    def poll(self) -> int | None: ...
    def wait(self, timeout: float) -> int: ...


def skip_if_crashed(program: str, status: int | None, output: str = "") -> None:
    """Skip the test if the program's exit status names a signal; `output` is the program's output."""
    if status is not None and status < 0:
        last = output.strip().rpartition("\n")[2]
        pytest.skip(f"{program} crashed: {signal.Signals(-status).name}{last and f' ({last})'}")


def run_peer(command: Sequence[str | Path], **options: Any) -> subprocess.CompletedProcess[str]:
    """Run another project's program, with options of `subprocess.run`, and skip the test if it crashes."""
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    skip_if_crashed(str(command[0]), done.returncode, done.stderr)
    return done


@contextmanager
def skipping_if_crashed(program: str, process: _Process) -> Iterator[None]:
    """Skip the test if its body fails and the program has crashed."""
    try:
        yield
    except BaseException:  # pytest's own failures are not derived from Exception
        with suppress(subprocess.TimeoutExpired):
            process.wait(SETTLING)
        skip_if_crashed(program, process.poll())
        raise


class RestartedPeer:
    """Program that is started again after a crash, up to `ATTEMPTS` times in all.

    Args:
        name: name of the program, for the message.
        start: function that starts it.
        output: function that returns its output since the last start.
    """

    def __init__(self, name: str, start: Callable[[], _Process], output: Callable[[], str]) -> None:
        self._name = name
        self._start = start
        self._output = output
        self._starts = 1
        self._process = start()

    def keep_running(self) -> None:
        """Start the program again if it crashed.

        After the last attempt, skip the test. If it exited by itself, fail.
        """
        status = self._process.poll()
        if status is None:
            return
        assert status < 0, f"{self._name} ended with exit status {status}\n{self._output()}"
        if self._starts == ATTEMPTS:
            skip_if_crashed(f"{self._name}, started {ATTEMPTS} times,", status, self._output())
        self._starts += 1
        self._process = self._start()
