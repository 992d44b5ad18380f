"""Record which kernels hunts call, and with arguments of which types: `python scripts/record_signatures.py`.

Run it when kernels are added, or called in another way; what is not recorded is compiled when it is first called.
"""

import os
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

FOLDER = TemporaryDirectory()
# Nothing is found compiled, so that all is seen.
os.environ["NUMBA_CACHE_DIR"] = FOLDER.name

from numba.core import event  # noqa: E402

from sim.numerics.signatures import RECORDED, as_line  # noqa: E402
from sim.team import Team  # noqa: E402
from ui.cli import main  # noqa: E402

STUDY = "robots: 2\n"


class CallsFromOutside(event.Listener):
    """What Python calls, with the seconds that it takes to compile it."""

    def __init__(self) -> None:
        self.lines: list[tuple[float, str]] = []
        self.ticks = 0
        self._began: list[float] = []

    def on_start(self, _: object) -> None:
        """A compilation begins."""
        self._began.append(time.process_time())

    def on_end(self, ended: event.Event) -> None:
        """A compilation has ended, perhaps one within another."""
        seconds = time.process_time() - self._began.pop()
        kernel = ended.data["dispatcher"]
        if not self._began and kernel.py_func.__module__.startswith(("sim.", "thbridge.")):
            line = as_line(kernel, ended.data["args"], moves=self.ticks > 0)
            self.lines.append((seconds, line))


# What was recorded before would be compiled ahead by others, out of sight.
RECORDED.write_text("")
calls = CallsFromOutside()
event.register("numba:compile", calls)
step = Team.step


def counted(*arguments: object) -> object:
    """A tick."""
    result = step(*arguments)
    calls.ticks += 1
    return result


Team.step = counted
sys.argv = [
    "thbridge",
    "play",
    "study.yaml",
    "--headless",
    "--port",
    "0",
    "--rate",
    "0",
    "--max-seconds",
    "25",
    "--no-report",
]
os.chdir(FOLDER.name)
Path("study.yaml").write_text(STUDY)
try:
    main()
except SystemExit:
    longest_first = sorted(calls.lines, reverse=True)
    RECORDED.write_text("".join(f"{line}\n" for _, line in longest_first))
    print(f"{len(longest_first)} calls, {sum(seconds for seconds, _ in longest_first):.1f} s of compiling")
    print(sum(seconds for seconds, line in longest_first if '"moves": false' in line), "s before the first tick")
