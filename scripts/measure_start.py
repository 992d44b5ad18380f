"""Measure the processor time of a headless game from its start to its first tick: `python scripts/measure_start.py`.

The first game compiles what is missing, and is not measured. Use a quiet machine.
"""

import argparse
import os
import statistics
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

ROOT = Path(__file__).parents[1]
PROGRAM = """\
import importlib.machinery, os, sys, time

class Finder(importlib.machinery.PathFinder):
    # Only the first import of sim.team is changed: importing it earlier would change the start.
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        if name != "sim.team":
            return None
        found = super().find_spec(name, path, target)
        load = found.loader.exec_module

        def load_measured(module):
            load(module)
            step = module.Team.step

            def measured(*arguments):
                step(*arguments)
                print(time.process_time(), file=open("seconds", "w"))
                os._exit(0)

            module.Team.step = measured

        found.loader.exec_module = load_measured
        return found

sys.meta_path.insert(0, Finder)
from ui.start import main
main()
"""
GAME = ("play", "--headless", "--robots", "2", "--port", "0", "--no-report", "--bag", "a.bag")


def seconds_to_first_tick() -> float:
    """Return the processor time, user and system, of one start, seconds."""
    with TemporaryDirectory() as folder:
        _play(folder, PROGRAM, *GAME)
        return float(Path(folder, "seconds").read_text())


def _play(folder: str, program: str, *arguments: str) -> None:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", program, *arguments]
    subprocess.run(command, cwd=folder, env=environment, capture_output=True, check=False)


def main() -> None:
    """Print the least and the median time of some starts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--starts", type=int, default=10, help="number of measured starts")
    starts = parser.parse_args().starts
    with TemporaryDirectory() as folder:
        # The end of this game is not needed, but the code of its classes is stored when it ends.
        _play(folder, "from ui.start import main; main()", *GAME, "--max-seconds", "40")
    seconds = [seconds_to_first_tick() for _ in range(starts)]
    print(f"processor seconds to the first tick: least {min(seconds):.2f}, median {statistics.median(seconds):.2f}")


if __name__ == "__main__":
    main()
