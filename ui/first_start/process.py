"""Program of a process that compiles before a hunt; it imports nothing else."""

import gc
import signal
import sys
from contextlib import suppress

from sim.numerics.signatures import compile_call


def compile_calls() -> None:
    """Compile the calls that arrive on standard input, and write an empty line after each."""
    # Only the hunt's process handles Ctrl-C. When it ends, the standard input of this process ends too.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # A compiler creates many objects but few reference cycles; a search for them would take an eighth of its time.
    gc.disable()
    for call in sys.stdin:
        # A kernel that fails to compile here is compiled when it is called, and then reports why it fails.
        with suppress(Exception):
            compile_call(call)
        sys.stdout.write("\n")
        sys.stdout.flush()
