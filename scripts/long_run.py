"""Run a session or a text server for a simulated day with all kinds of clients, and report which resources have grown.

Run this script from the project's folder. `make long-run` (`scripts/long_run.py session`) starts `thbridge play` on a
virtual X server, with a participant's window. It connects a simulated participant who plays repeatedly, a researcher's
watcher, a ROS node and a MAVLink station, each in a separate program. Short-lived programs connect and leave. `server`
starts `thbridge server`, `simr` and `hider`; the simulated participant plays short games there.

Samples of memory, descriptors, threads, processor time, files and waiting times are written to FOLDER/samples.csv;
`plot SAMPLES --to PICTURE` draws them. All three commands print the growth after a warm-up, and exit with 1 if a growth
exceeds its bound. `xdotool` starts the window's game by a key press; `make peers` installs xdotool and Xvfb.
"""

import argparse
import asyncio
import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path

from endurance.companions import COMPANIONS, HOST, accompany
from endurance.curves import draw
from endurance.growth import Samples, judge
from endurance.sampling import Sampler, Visitors
from free_ports import free_ports

from thbridge.text_protocol.wire import legacy

THBRIDGE = (sys.executable, "-c", "from ui.cli import main; main()")
PATIENCE = 300.0
"""Timeout for the start of a program, seconds."""
VISITS = 2.0
"""Seconds between two test connections."""
STUDY = """\
map: arena8
templates: original-2016
robots: {robots}
seed: 3
recording:
  split_size: 200
mavlink:
  lost_after: 600
  position_rate: 1
participant:
  sound: false
game:
  energy: {energy}
"""
"""Study of the run.

The bag has parts of 200 MB, so that finished parts can be removed. The limit of `lost_after` is long, because stations
use wall time, in which a simulated hour takes only some minutes.
"""


class Running:
    """Programs of a run, which end when the run ends.

    Args:
        folder: folder of the run, in which programs run and write their output.
        opened: stack of programs and files to close.
    """

    def __init__(self, folder: Path, opened: ExitStack) -> None:
        self.folder = folder
        self.environment = {
            **os.environ,
            "PYTHONPATH": str(Path.cwd()),
            "XDG_CONFIG_HOME": str(folder / "home"),
            "PYTHONUNBUFFERED": "1",
        }
        self.environment.pop("QT_QPA_PLATFORM", None)
        self._opened = opened

    def thbridge(self, name: str, *words: str) -> subprocess.Popen[bytes]:
        """Start a thbridge program."""
        return self._start(name, *THBRIDGE, *words)

    def companion(self, name: str, *words: str) -> subprocess.Popen[bytes]:
        """Start a companion."""
        script = str(Path(__file__).resolve())
        return self._start(name, sys.executable, script, "companion", name, "--folder", str(self.folder), *words)

    def wait(self, name: str, words: str, process: subprocess.Popen[bytes]) -> None:
        """Wait until a program has printed these words. Raise RuntimeError if it ends earlier, or after the timeout."""
        path, until = self.folder / f"{name}.txt", time.monotonic() + PATIENCE
        while words not in path.read_text(errors="replace"):
            if process.poll() is not None or time.monotonic() > until:
                raise RuntimeError(f"{name} did not print {words!r}:\n{path.read_text(errors='replace')[-2000:]}")
            time.sleep(0.1)

    def _start(self, name: str, *words: str) -> subprocess.Popen[bytes]:
        output = self._opened.enter_context((self.folder / f"{name}.txt").open("wb"))
        process = subprocess.Popen(
            words, cwd=self.folder, stdout=output, stderr=output, stdin=subprocess.DEVNULL, env=self.environment
        )
        self._opened.callback(end, process)
        return process


def end(process: subprocess.Popen[bytes]) -> None:
    """End a program properly."""
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(90)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


@contextlib.contextmanager
def x_server() -> Iterator[str]:
    """Start a virtual X server; yield its DISPLAY."""
    reading, writing = os.pipe()
    words = ["Xvfb", "-displayfd", str(writing), "-screen", "0", "1024x768x24", "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(words, pass_fds=(writing,), stderr=subprocess.DEVNULL)
    os.close(writing)
    with os.fdopen(reading) as answer:
        place = answer.readline().strip()
    try:
        yield f":{place}"
    finally:
        end(server)


def begin_game(environment: Mapping[str, str]) -> None:
    """Press the default button of the window's start page."""

    def do(*words: str) -> str:
        done = subprocess.run(["xdotool", *words], env=environment, capture_output=True, text=True, check=False)
        return done.stdout.strip()

    until = time.monotonic() + PATIENCE
    while not (window := do("search", "--onlyvisible", "--name", "^Treasure hunt").split("\n")[-1]):
        if time.monotonic() > until:
            raise RuntimeError("the participant's window did not open")
        time.sleep(0.2)
    do("windowfocus", "--sync", window)
    time.sleep(2.0)
    do("key", "Return")


def give_way(pid: int) -> None:
    """Lower the priority of a process, because the session needs a processor core of its own."""
    os.setpriority(os.PRIO_PROCESS, pid, 10)
    # Linux groups processes by session, and priorities apply only within a group.
    if os.getsid(pid) == pid:
        with contextlib.suppress(OSError):
            Path(f"/proc/{pid}/autogroup").write_text("5")


def run_session(given: argparse.Namespace, running: Running, opened: ExitStack) -> None:
    """Run `thbridge play` with all kinds of clients."""
    running.environment["DISPLAY"] = opened.enter_context(x_server())
    text, door, tcp, ros = free_ports(4)
    words = ["play", "study.yaml", "--rate", "0", "--bag", "hunt.bag", "--no-report", "--port", str(text)]
    words += ["--watch", str(door), "--ros", "--ros-master", f"http://{HOST}:{ros}"]
    words += ["--mavlink", "--tcp", f"{HOST}:{tcp}", "--max-seconds", str(given.hours * 36000)]
    program = running.thbridge("session", *words)
    begin_game(running.environment)
    running.wait("session", "join at", program)
    window = int(Path(f"/proc/{program.pid}/task/{program.pid}/children").read_text().split()[-1])
    robots = ["--robots", str(given.robots)]
    companions = {
        "participant": running.companion("participant", "--text", str(text), "--name", "Simulated"),
        "watcher": running.companion("watcher", "--watch", str(door), *robots),
        "node": running.companion("node", "--ros", str(ros), *robots),
        "station": running.companion("station", "--mavlink", str(tcp), *robots),
    }
    others = {"window": window} | {name: process.pid for name, process in companions.items()}
    for pid in others.values():
        give_way(pid)
    sample_until(given, {"session": program.pid} | others, Visitors(text, door), program)


def run_server(given: argparse.Namespace, running: Running, opened: ExitStack) -> None:
    """Run `thbridge server` with robots and treasures, and play games one after the other."""
    text, door = free_ports(2)
    server = running.thbridge("server", "server", "study.yaml", "--port", str(text), "--journal", "journal")
    running.wait("server", "listening on", server)
    at = ["--server", f"{HOST}:{text}"]
    rate = ["--rate", str(given.rate)]
    robots = running.thbridge("robots", "simr", "study.yaml", *at, *rate, "--watch", str(door))
    hider = running.thbridge("hider", "hider", "study.yaml", *at)
    running.wait("robots", "connected", robots)
    player = running.companion("participant", "--text", str(text), "--name", legacy.TABUI)
    watcher = running.companion("watcher", "--watch", str(door), "--robots", str(given.robots))
    programs = {"server": server, "robots": robots, "hider": hider, "participant": player, "watcher": watcher}
    sample_until(given, {name: each.pid for name, each in programs.items()}, Visitors(text, door), server)


def sample_until(
    given: argparse.Namespace, processes: Mapping[str, int], visitors: Visitors, program: subprocess.Popen[bytes]
) -> None:
    """Take samples for the simulated hours, or until the time limit. Raise RuntimeError if the program ends earlier."""
    sampler = Sampler(given.folder, processes, visitors)
    began = sampled = time.monotonic()
    row: Mapping[str, float] = sampler.sample()
    while time.monotonic() - began < given.minutes * 60 and row["sim_s"] < given.hours * 3600:
        if program.poll() is not None:
            raise RuntimeError("the program ended too early; see its output in the folder of the run")
        visitors.visit()
        time.sleep(VISITS)
        if time.monotonic() - sampled >= given.every:
            sampled = time.monotonic()
            row = sampler.sample()
            print(json.dumps(row), flush=True)


def run(given: argparse.Namespace) -> None:
    """Run the programs, and take samples."""
    signal.signal(signal.SIGTERM, lambda _number, _frame: sys.exit(1))  # so that all started programs also end
    given.folder = given.folder.resolve()
    shutil.rmtree(given.folder, ignore_errors=True)
    given.folder.mkdir(parents=True)
    (given.folder / "study.yaml").write_text(STUDY.format(robots=given.robots, energy=given.energy))
    with ExitStack() as opened:
        (run_session if given.kind == "session" else run_server)(given, Running(given.folder, opened), opened)


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    kinds = parser.add_subparsers(dest="kind", required=True)
    for kind, robots, energy in (("session", 6, 100), ("server", 2, 30)):
        runs = kinds.add_parser(kind)
        runs.add_argument("--robots", type=int, default=robots)
        runs.add_argument(
            "--energy", type=float, default=energy, help="energy of a robot; less energy makes games shorter"
        )
        runs.add_argument("--hours", type=float, default=24.0, help="simulated hours")
        runs.add_argument("--minutes", type=float, default=1000.0, help="greatest wall time, minutes")
        runs.add_argument("--every", type=float, default=30.0, help="seconds of wall time between two samples")
        runs.add_argument("--folder", type=Path, default=Path("long-run"))
        runs.add_argument("--to", type=Path, help="picture file for the curves")
        if kind == "server":
            runs.add_argument(
                "--rate", type=float, default=10000.0, help="greatest number of simulated seconds per real second"
            )
    drawn = kinds.add_parser("plot")
    drawn.add_argument("samples", type=Path)
    drawn.add_argument("--to", type=Path, help="picture file for the curves")
    companion = kinds.add_parser("companion")
    companion.add_argument("companion", choices=list(COMPANIONS))
    companion.add_argument("--folder", type=Path)
    companion.add_argument("--name")
    for door in ("text", "watch", "ros", "mavlink", "robots"):
        companion.add_argument(f"--{door}", type=int, default=0)
    given = parser.parse_args()
    if given.kind == "companion":
        asyncio.run(accompany(given))
        return 0
    if given.kind != "plot":
        run(given)
    samples = Samples(given.samples if given.kind == "plot" else given.folder / "samples.csv")
    if given.to is not None:
        draw(samples, given.to)
    return 0 if judge(samples) else 1


if __name__ == "__main__":
    sys.exit(main())
