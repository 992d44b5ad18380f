"""The first start, which compiles the simulator: what hunts need is compiled ahead of them, on several cores."""

import gc
import os
import signal
import subprocess
import sys
from contextlib import suppress
from queue import SimpleQueue
from threading import Thread

from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from sim.numerics.signatures import RECORDED, compile_call, missing
from sim.numerics.sources import ROOT
from ui.terminal import err, note

COMPILERS = 4
"""Processes that compile, at most: each takes 200 MB."""
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
        whole_hunt: return when all is done; else when the first tick can be, and the rest is compiled beside the hunt.
    """
    first = missing(before_moves=not whole_hunt)
    later = [call for call in missing(before_moves=False) if call not in first]
    if not first and not later:
        return
    compilers = min(_cores(), COMPILERS, len(first) + len(later))
    done = _compiled([*first, *later], compilers)
    if not err.is_terminal:
        note(f"{NOTICE}.")
    columns = (TextColumn(NOTICE), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=err, transient=True, disable=not err.is_terminal) as bar:
        task, left = bar.add_task("", total=len(first)), set(first)
        while left and compilers:
            call = done.get()
            left.discard(call)
            compilers -= not call
            bar.update(task, completed=len(first) - len(left))


def compile_calls() -> None:
    """Compile the calls that come in on standard input, and say so of each: the program of a process beside a hunt."""
    # Ctrl-C is for the hunt; with it, the input ends.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # A compiler makes few cycles, and many objects that are looked through for them: an eighth of its time.
    gc.disable()
    for call in sys.stdin:
        # A kernel that cannot be compiled so is compiled when it is called, and then says why not.
        with suppress(Exception):
            compile_call(call)
        sys.stdout.write("\n")
        sys.stdout.flush()


def _compiled(calls: list[str], compilers: int) -> SimpleQueue[str]:
    """Return a queue of calls that were compiled, filled by as many processes, each of which ends with an empty one."""
    ahead, done = iter(calls), SimpleQueue[str]()
    command = [sys.executable, "-P", "-c", "from ui.first_start import compile_calls; compile_calls()"]
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
                print(call, file=process.stdin, flush=True)
                if not (process.stdout and process.stdout.readline()):
                    break
                done.put(call)
        done.put("")

    for _ in range(compilers):
        Thread(target=hand_out, daemon=True).start()
    return done


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
