"""Program of a process that compiles kernels before a hunt. It imports only what compiling needs."""

import gc
import signal
import sys
from contextlib import suppress

from sim.numerics.signatures import compile_call


def compile_calls() -> None:
    """Compile the calls that arrive on standard input, and write an empty line after each."""
    # Only the hunt's process handles Ctrl-C. When that process ends, the standard input of this process ends, too.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    # A compiler creates many objects but few reference cycles. Searching for cycles would take an eighth of the time.
    gc.disable()
    for call in sys.stdin:
        # If a kernel cannot be compiled here, the hunt compiles it when it is called, and then the error is reported.
        with suppress(Exception):
            compile_call(call)
        sys.stdout.write("\n")
        sys.stdout.flush()
