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

from sim.numerics.signatures import RECORDED, as_line, is_kernel  # noqa: E402
from sim.team import Team  # noqa: E402
from ui.cli import main  # noqa: E402

STUDY = "robots: 2\n"


class Compilations(event.Listener):
    """Kernels in the order in which a hunt has them compiled, what they call before them, with the seconds of each."""

    def __init__(self) -> None:
        self.lines: list[tuple[float, str]] = []
        self.ticks = 0
        self._own: list[float] = []
        self._since = 0.0

    def on_start(self, _: object) -> None:
        """A compilation begins."""
        self._switch()
        self._own.append(0.0)

    def on_end(self, ended: event.Event) -> None:
        """A compilation has ended, perhaps one within another."""
        self._switch()
        seconds = self._own.pop()
        kernel = ended.data["dispatcher"]
        # Formulas go by a name that is a plain function's.
        if is_kernel(kernel):
            self.lines.append((seconds, as_line(kernel, ended.data["args"], moves=self.ticks > 0)))
        elif self._own:
            self._own[-1] += seconds

    def _switch(self) -> None:
        now = time.process_time()
        if self._own:
            self._own[-1] += now - self._since
        self._since = now


# What was recorded before would be compiled ahead by others, out of sight.
RECORDED.write_text("")
calls = Compilations()
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
    RECORDED.write_text("".join(f"{line}\n" for _, line in calls.lines))
    print(f"{len(calls.lines)} kernels, {sum(seconds for seconds, _ in calls.lines):.1f} s of compiling")
    print(sum(seconds for seconds, line in calls.lines if '"moves": false' in line), "s before the first tick")
