"""The program of a process that compiles ahead of a hunt, and imports nothing else."""

import gc
import signal
import sys
from contextlib import suppress

from sim.numerics.signatures import compile_call


def compile_calls() -> None:
    """Compile the calls that come in on standard input, and say so of each."""
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
