"""Record the kernels that hunts call, with the types of their arguments: `python scripts/record_signatures.py`.

Run this script when kernels are added or their calls change. Kernels that are not recorded are compiled at their first
call.
"""

import os
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from unittest.mock import patch

FOLDER = TemporaryDirectory()
# The cache is empty, so that this script observes every compilation.
os.environ["NUMBA_CACHE_DIR"] = FOLDER.name

from numba.core import event  # noqa: E402

from sim.inputs import TeamInput  # noqa: E402
from sim.numerics.signatures import RECORDED, as_line, is_kernel  # noqa: E402
from sim.snapshot import TeamSnapshot  # noqa: E402
from sim.team import Team  # noqa: E402
from ui.cli import main  # noqa: E402

STUDY = "robots: 2\n"


class Compilations(event.Listener):  # type: ignore[misc]  # numba has no types
    """Kernels in the order in which a hunt compiles them (inner kernels first), with their compile times in seconds."""

    def __init__(self) -> None:
        self.lines: list[tuple[float, str]] = []
        self.ticks = 0
        self._own: list[float] = []
        self._since = 0.0

    def on_start(self, _: object) -> None:
        """Handle the beginning of a compilation."""
        self._switch()
        self._own.append(0.0)

    def on_end(self, ended: event.Event) -> None:
        """Handle the end of a compilation, which may be nested in another compilation."""
        self._switch()
        seconds = self._own.pop()
        kernel = ended.data["dispatcher"]
        # Formulas are compiled under the name of a plain function. Their time counts for the kernel that calls them.
        if is_kernel(kernel):
            self.lines.append((seconds, as_line(kernel, ended.data["args"], moves=self.ticks > 0)))
        elif self._own:
            self._own[-1] += seconds

    def _switch(self) -> None:
        now = time.process_time()
        if self._own:
            self._own[-1] += now - self._since
        self._since = now


# Without this, other processes would compile the recorded kernels, and this process would not observe them.
RECORDED.write_text("")
calls = Compilations()
event.register("numba:compile", calls)
step = Team.step


def counted(team: Team, inputs: Sequence[TeamInput] = ()) -> TeamSnapshot:
    """Run a tick, and count it."""
    snapshot = step(team, inputs)
    calls.ticks += 1
    return snapshot


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
    with patch.object(Team, "step", counted):
        main()
except SystemExit:
    RECORDED.write_text("".join(f"{line}\n" for _, line in calls.lines))
    print(f"{len(calls.lines)} kernels, {sum(seconds for seconds, _ in calls.lines):.1f} s of compiling")
    print(sum(seconds for seconds, line in calls.lines if '"moves": false' in line), "s before the first tick")
