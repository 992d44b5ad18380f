"""Compiling at the first start: the kernels that hunts need are compiled on several cores before the hunt."""

import os
import subprocess
import sys
from contextlib import suppress
from threading import Event, Thread

from sim.numerics.kernels import wait_for_others
from sim.numerics.signatures import kept_at, missing, recorded_calls
from ui.command_line.terminal import FAILED, err, fail, note
from ui.first_start.bar import (
    FIRST_START,
    START_BAR,
    STOPPED,
    is_unfinished,
    mark_begun,
    mark_compiled,
    own_environment,
)

COMPILERS = 4
"""Maximum number of processes that compile. Each process needs 200 MB of memory."""
BESIDE = 5
"""Niceness of processes that compile during a hunt."""
PERIOD = 0.2
"""Seconds between two updates of the progress."""


def announce_compiling() -> None:
    """Print that the simulator is compiled first, if no kernel has been compiled yet."""
    if len(missing(before_moves=False)) == len(recorded_calls()):
        note(FIRST_START)


def compile_ahead(*, whole_hunt: bool, look: str | None = None) -> None:
    """Compile the kernels that a hunt usually needs, and show the progress. Ctrl-C and *Cancel* end the program.

    Args:
        whole_hunt: True to return when all kernels are compiled. False to return when the first tick can run. The rest
            is then compiled during the hunt, which waits for kernels that it needs. Kernels that an earlier start did
            not finish are always compiled before the hunt, because a series of short hunts would never compile them.
        look: colors of the window with the bar. If None, there is no window.
    """
    calls = missing(before_moves=False)
    unfinished = is_unfinished()
    first = calls if whole_hunt or unfinished else missing(before_moves=True)
    try:
        if calls:
            START_BAR.open(look)
            if not err.is_terminal:
                note(_notice(len(calls), unfinished))
            mark_begun()
            later = [call for call in calls if call not in first]
            _wait_for([*first], _compiled([*first, *later], beside=set(later)))
        if len(first) == len(calls):
            mark_compiled()
    except KeyboardInterrupt:
        START_BAR.stop_compiling()
        START_BAR.close()
        fail(FAILED, STOPPED)
    finally:
        START_BAR.close()


def _notice(count: int, unfinished: bool) -> str:
    """Return a sentence about the number of parts that this start compiles, and the reason."""
    total = len(recorded_calls())
    if count == total:
        return FIRST_START
    why = ", because an earlier start did not finish" if unfinished else ""
    return f"Compiling {count} of {total} parts of the simulator for this machine{why}."


def _wait_for(calls: list[str], done: dict[str, Event]) -> None:
    """Wait until calls are compiled, and show the number of compiled calls."""
    while left := [call for call in calls if not done[call].is_set()]:
        START_BAR.show(len(calls) - len(left), len(calls))
        done[left[0]].wait(PERIOD)


def _compiled(calls: list[str], beside: set[str]) -> dict[str, Event]:
    """Return an event for each call. It is set when the call is compiled, or when no process is left to compile it.

    Other processes compile the calls in the given order. Before the hunt's process compiles a call itself, it waits for
    the event. Calls in `beside` are compiled during the hunt, at low priority.
    """
    done = {call: Event() for call in calls}
    answered: list[str] = []
    wait_for_others({kept_at(call): compiled.wait for call, compiled in done.items()})
    ahead = iter(calls)
    command = [sys.executable, "-P", "-c", "from ui.first_start.process import compile_calls; compile_calls()"]

    def hand_out() -> None:
        process = subprocess.Popen(
            command,
            env=own_environment(),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        START_BAR.compilers.add(process)
        with suppress(BrokenPipeError), process:
            for call in ahead:
                try:
                    if call in beside:
                        os.setpriority(os.PRIO_PROCESS, process.pid, BESIDE)
                    print(call, file=process.stdin, flush=True)
                    if not (process.stdout and process.stdout.readline()):
                        break
                    answered.append(call)
                finally:
                    done[call].set()

    def hand_out_all() -> None:
        helpers = [Thread(target=hand_out, daemon=True) for _ in range(min(usable_cores(), COMPILERS, len(calls)))]
        for helper in helpers:
            helper.start()
        for helper in helpers:
            helper.join()
        for compiled in done.values():
            compiled.set()
        if len(answered) == len(calls):
            mark_compiled()

    Thread(target=hand_out_all, daemon=True).start()
    return done


def usable_cores() -> int:
    """Return the number of cores that this process may use; on macOS, the number of all cores."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
