"""The first start, which compiles the simulator: what hunts need is compiled ahead of them, on several cores."""

import os
import subprocess
import sys
from contextlib import suppress
from threading import Event, Thread

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from sim.numerics.kernels import wait_for_others
from sim.numerics.signatures import RECORDED, kept_at, missing
from sim.numerics.sources import ROOT
from ui.terminal import err, note

COMPILERS = 4
"""Processes that compile, at most: each takes 200 MB."""
BESIDE = 5
"""How nice processes are that compile beside a hunt."""
NOTICE = "Compiling the simulator for this machine, at the first start only"


def is_compiled() -> bool:
    """Return True when all that hunts usually need was compiled before; else the first takes longer to begin."""
    return not missing(before_moves=False)


def announce_compiling() -> None:
    """Tell that the first start takes its time, where nothing was compiled yet."""
    if len(missing(before_moves=False)) == len(RECORDED.read_text(encoding="utf-8").splitlines()):
        note(f"{NOTICE}.")


def compile_ahead(*, whole_hunt: bool) -> None:
    """Compile what a hunt usually needs, and show how far that is.

    Args:
        whole_hunt: return when all is done; else when the first tick can be, and the rest is compiled beside the hunt,
            which waits for what it needs and has not.
    """
    calls = missing(before_moves=False)
    first = calls if whole_hunt else missing(before_moves=True)
    if not calls:
        return
    done = _compiled([*first, *(call for call in calls if call not in first)], beside=set(calls).difference(first))
    if not err.is_terminal:
        note(f"{NOTICE}.")
    columns = (TextColumn(NOTICE), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=err, transient=True, disable=not err.is_terminal) as bar:
        for call in bar.track(first, description=""):
            done[call].wait()


def _compiled(calls: list[str], beside: set[str]) -> dict[str, Event]:
    """Return what is set when a call was compiled, or nobody is left who might.

    Processes compile the calls as they are sorted. This one waits for them before it would compile one itself; those
    beside a hunt take what time others leave.
    """
    done = {call: Event() for call in calls}
    wait_for_others({kept_at(call): compiled.wait for call, compiled in done.items()})
    ahead = iter(calls)
    command = [sys.executable, "-P", "-c", "from ui.compiler_process import compile_calls; compile_calls()"]
    # The same sources, wherever these were found.
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])}

    def hand_out() -> None:
        process = subprocess.Popen(
            command,
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        with suppress(BrokenPipeError), process:
            for call in ahead:
                try:
                    if call in beside:
                        os.setpriority(os.PRIO_PROCESS, process.pid, BESIDE)
                    print(call, file=process.stdin, flush=True)
                    if not (process.stdout and process.stdout.readline()):
                        break
                finally:
                    done[call].set()

    def hand_out_all() -> None:
        helpers = [Thread(target=hand_out, daemon=True) for _ in range(min(_cores(), COMPILERS, len(calls)))]
        for helper in helpers:
            helper.start()
        for helper in helpers:
            helper.join()
        for compiled in done.values():
            compiled.set()

    Thread(target=hand_out_all, daemon=True).start()
    return done


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
