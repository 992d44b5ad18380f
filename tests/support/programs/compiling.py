"""Compile the kernels that tests use, once for this machine and these sources.

    python -m tests.support.programs.compiling

Without this, each test process would compile the kernels itself, and tests that wait for a program would also wait for
the compiler.
"""

import os
import subprocess
import sys
import time
from pathlib import Path
from tempfile import TemporaryDirectory

from sim.numerics.kernels import folder_of
from tests.support.project import ROOT

STUDIES = (
    "robots: 2\n",
    """\
robots: 3
robot:
  localization: ekf
  move_base:
    base_local_planner: dwa_local_planner/DWAPlannerROS
    base_global_planner: global_planner/GlobalPlanner
each: {2: {localization: ukf}}
things:
  - {name: door, shape: door, at: [7.0, -4.0, 1.5708], size: [2.0, 0.1]}
  - {name: crate, shape: crate, at: [3.0, 1.0, 0.5], appears: 2}
  - {name: visitor, shape: person, path: [[0, 2.0], [6, 2.0]], back_and_forth: true}
""",
)
"""Short hunts that use the default software of robots, and many of its alternatives."""


def compile_kernels() -> float:
    """Play the hunts, unless that was done before; return the seconds that this took."""
    # `team.py` imports all modules of the simulator: if any of its sources changes, the folder has another name.
    done = folder_of(ROOT / "sim" / "team.py") / "for_tests"
    if done.exists():
        return float(done.read_text())
    began = time.monotonic()
    hunt = ("play", "study.yaml", "--headless", "--port", "0", "--rate", "0", "--max-seconds", "25", "--no-report")
    with TemporaryDirectory() as folder:
        hunts = []
        for number, study in enumerate(STUDIES):
            place = Path(folder, str(number))
            place.mkdir()
            Path(place, "study.yaml").write_text(study)
            hunts.append(
                subprocess.Popen(
                    [sys.executable, "-c", "from ui.cli import main; main()", *hunt],
                    cwd=place, env={**os.environ, "PYTHONPATH": str(ROOT)}, text=True,
                    stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                )
            )  # fmt: skip
        # The hunts run at the same time, on all cores. If one of them compiles a kernel that another needs, the other
        # waits.
        told = [played.communicate()[1] for played in hunts]
    for said in told:
        if "The game did not end" not in said:
            raise RuntimeError(said)
    seconds = time.monotonic() - began
    done.parent.mkdir(mode=0o700, exist_ok=True)
    done.write_text(f"{seconds:.1f}")
    return seconds


def compile_tests() -> None:
    """Let pytest compile the tests of a fresh checkout; otherwise each test process would compile all of them."""
    if not any((ROOT / "tests" / "__pycache__").glob("conftest.*-pytest-*.pyc")):
        command = (sys.executable, "-m", "pytest", "--collect-only", "--quiet")
        # Errors in a test are reported when it runs.
        subprocess.run(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)


if __name__ == "__main__":
    compile_kernels()
    compile_tests()
