"""Run a session or a text server for a simulated day, with everybody connected, and tell what has grown.

Run it from the project's folder. `.venv/bin/python scripts/long_run.py session` (`make long-run`) starts `thbridge play`
on an X server without a screen, with a participant's window, and connects a simulated participant who plays again and
again, a researcher's watcher, a ROS node and a MAVLink station, each a program of its own; other programs come and go.
`server` starts `thbridge server`, `simr` and `hider`, where the same participant plays short games one after the other.

Samples of memory, descriptors, threads, processor time, files and waits go into FOLDER/samples.csv; `plot SAMPLES --to
PICTURE` draws them. All three print the growth after a warm-up, and end with 1 where it is beyond its bound. The window's
game is begun by a key, through `xdotool`; `make peers` installs it and Xvfb.
"""

import argparse
import asyncio
import contextlib
import csv
import dataclasses
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import matplotlib as mpl
import numpy as np
from scipy import stats

from sim.common.geometry import Pose2
from sim.common.observations import TICK
from sim.inputs import ClearCostmaps
from sim.numerics.float_array import FloatArray
from thbridge.app.compose.game import build_bot
from thbridge.app.programs import exchange
from thbridge.app.session.watch_requests import request_line
from thbridge.dialogue.games.strategies import Attitude
from thbridge.files.resources import shipped
from thbridge.files.template_files import read_template_set
from thbridge.protocols.mavlink.dialect import Message, mav
from thbridge.protocols.mavlink.station.ground_station import GroundStation, KnownRobot, StationEvent
from thbridge.protocols.mavlink.station.trip import StationTrip
from thbridge.protocols.mavlink.vehicle_interface import Target
from thbridge.protocols.text import legacy
from thbridge.protocols.text.lines import TextMessage
from thbridge.protocols.text.notice import is_notice
from thbridge.protocols.watching import SessionMessage, parse_status
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.view import ParticipantRequest, PlayAgain, View
from thbridge.sockets.addresses import Address
from thbridge.sockets.mavlink.client import open_station
from thbridge.sockets.reconnecting import ConnectionLost
from thbridge.sockets.rosgraph.node import RosNode
from thbridge.sockets.text.client import TextClient
from thbridge.sockets.watching.client import WatchClient, WatchConnected

mpl.use("Agg")
from matplotlib import pyplot as plt

HOST = "127.0.0.1"
THBRIDGE = (sys.executable, "-c", "from ui.cli import main; main()")
DAY = 24 * 3600.0
PATIENCE = 300.0
"""Seconds to wait for a program to start."""
PASSES = 10.0
"""Seconds between two visits of programs that come and go."""
TOLD = 2.0
"""Seconds between two reports of a companion."""


# Companions, each a process


class Report:
    """Counters of a companion, which the sampler reads from a file."""

    def __init__(self, path: Path) -> None:
        self.counts: Counter[str] = Counter()
        self._path = path

    async def keep(self) -> None:
        """Write the counters again and again."""
        while True:
            beside = self._path.with_suffix(".new")
            beside.write_text(json.dumps(self.counts))
            beside.replace(self._path)
            await asyncio.sleep(TOLD)


class PlaysAgain:
    """Player that begins another game whenever one is over."""

    def __init__(self, report: Report) -> None:
        self._report = report
        self._templates = read_template_set(shipped().find("templates", "original-2016", Path()))
        self._game = -1

    def requests(self, view: View) -> Sequence[ParticipantRequest]:
        """See `Player`."""
        if view.over is not None:
            self._report.counts["over"] = view.game
            return (PlayAgain(view.game),)
        if view.game != self._game:
            self._game = self._report.counts["game"] = view.game
            self._bot = build_bot(self._templates, BotStrategy.SUGGESTION, view.game, Attitude.CREDULOUS)
        return self._bot.requests(view)


class SecondSeat:
    """TabUI's role under another name, so that it plays beside a participant's window.

    Args:
        role: whose notices are said in that name.
        name: of the program.
    """

    def __init__(self, role: TabUI, name: str) -> None:
        self._role = role
        self._name = name
        self._began = time.monotonic()
        self._messages: list[TextMessage] = []

    def connected(self) -> None:
        """See `RoleRunner`, for this and the next two."""
        self._role.connected()

    def receive(self, message: TextMessage) -> None:
        """Keep a message for the next step."""
        self._messages.append(message)

    def step(self) -> Sequence[TextMessage]:
        """Return the role's messages; notices are believed in the name of their connection only."""
        messages, self._messages = self._messages, []
        said = self._role.step(int((time.monotonic() - self._began) / TICK), messages)
        return [dataclasses.replace(each, sender=self._name) if is_notice(each) else each for each in said]


async def participate(report: Report, given: argparse.Namespace) -> None:
    """Play games, one after the other."""
    client = TextClient(given.name, "1", HOST, given.text)

    def lost(loss: ConnectionLost) -> None:
        report.counts["lost"] += 1

    runner = SecondSeat(TabUI(PlaysAgain(report)), given.name)
    async with client.running():
        while True:
            exchange(runner, client, lost)
            await asyncio.sleep(0.005)


async def watch(report: Report, given: argparse.Namespace) -> None:
    """Watch as a researcher's window does, and ask for something now and then."""
    client = WatchClient(HOST, given.watch)
    running = asyncio.create_task(client.run())
    asked = time.monotonic()
    while not running.done():
        for event in client.take():
            match event:
                case WatchConnected():
                    report.counts["connected"] += 1
                case ConnectionLost():
                    report.counts["lost"] += 1
                case SessionMessage():
                    report.counts["messages"] += 1
                    status = parse_status(event)
                    if status is None:
                        report.counts["stamp_ms"] = event.stamp_ns // 1_000_000
                    else:
                        report.counts["dropped"] = status.dropped
                        report.counts["refusals"] = status.refusals
        if time.monotonic() - asked > PASSES:
            asked = time.monotonic()
            report.counts["asked"] += 1
            client.send(request_line("long run", ClearCostmaps(report.counts["asked"] % given.robots)))
        await asyncio.sleep(0.02)


async def subscribe(report: Report, given: argparse.Namespace) -> None:
    """Subscribe to topics of all robots, and let nodes come and go besides."""

    def count(_data: bytes, _publisher: str) -> None:
        report.counts["messages"] += 1

    topics = ["/tf", "/clock", *(f"/robot{each + 1}/{name}" for each in range(given.robots) for name in ROBOT_TOPICS)]
    standing = await node(given.ros, "/long_run", topics, count)
    try:
        while True:
            await asyncio.sleep(PASSES)
            passing = await node(given.ros, f"/passing{report.counts['passed']}", topics[:3], count)
            await passing.registered()
            await asyncio.sleep(1.0)
            await passing.stop()
            report.counts["passed"] += 1
    finally:
        await standing.stop()


ROBOT_TOPICS = ("scan", "odom", "amcl_pose", "cmd_vel")


async def node(master: int, name: str, topics: Sequence[str], take: Callable[[bytes, str], None]) -> RosNode:
    """Start a node that subscribes."""
    made = RosNode(name, f"http://{HOST}:{master}")
    for topic in topics:
        made.subscribe(topic, "*", "*", take)
    await made.start()
    return made


class ListingStation(GroundStation):
    """Ground station that also lists parameters."""

    def __init__(self, report: Report) -> None:
        super().__init__()
        self._report = report

    def list_parameters(self, system: int) -> None:
        """Ask a robot for all its parameters."""
        self._send(mav.MAVLink_param_request_list_message(system, mav.MAV_COMP_ID_AUTOPILOT1))

    def _handle(self, robot: KnownRobot, message: Message, now: float) -> list[StationEvent]:
        self._report.counts["messages"] += 1
        if isinstance(message, mav.MAVLink_param_value_message):
            self._report.counts["parameters"] += 1
        return super()._handle(robot, message, now)


async def command(report: Report, given: argparse.Namespace) -> None:
    """Send heartbeats, list parameters, and drive a robot now and then, which is given back then."""
    corridor = [Pose2(x, y, 0.0) for x, y in ((0.0, 1.0), (4.0, 1.0), (6.0, 1.0))]
    async with open_station(Address(HOST, given.mavlink), True, None) as link:
        link.station = station = ListingStation(report)
        began, trips = time.monotonic(), 0
        trip: StationTrip | None = None
        while True:
            events, now = await link.poll(), time.monotonic()
            report.counts["frames"] = sum(each.frames for each in station.robots.values())  # of integers
            if trip is not None:
                trip.advance(events, now)
                if trip.outcome is not None:
                    report.counts["trips"] += 1
                    report.counts["failed trips"] += bool(trip.outcome.problem)
                    trip, began = None, now
            elif len(station.robots) == given.robots and now - began > 3 * PASSES:
                robot = 1 + trips % given.robots
                station.list_parameters(robot)
                place = corridor[trips % len(corridor)]
                trip = StationTrip(station, robot, target_at(place), False, now)
                trips += 1


def target_at(place: Pose2) -> Target:
    """A place of the map without a heading."""
    return Target(place.x, place.y)


COMPANIONS: Mapping[str, Callable[[Report, argparse.Namespace], Coroutine[None, None, None]]] = {
    "participant": participate,
    "watcher": watch,
    "node": subscribe,
    "station": command,
}


async def accompany(given: argparse.Namespace) -> None:
    """Run a companion until it is ended."""
    report = Report(given.folder / f"{given.companion}.json")
    keeping = asyncio.create_task(report.keep())
    try:
        await COMPANIONS[given.companion](report, given)
    finally:
        keeping.cancel()


# Samples


@dataclass(frozen=True, slots=True)
class Load:
    """What a process holds and has used: resident megabytes, descriptors, threads, seconds of processor time."""

    memory: float
    descriptors: int
    threads: int
    processor: float


def load_of(pid: int) -> Load:
    """Return what a process holds now. Raises OSError: it has ended."""
    process = Path(f"/proc/{pid}")
    pages = int((process / "statm").read_text().split()[1])
    fields = (process / "stat").read_text().rpartition(")")[2].split()
    used = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
    return Load(pages * os.sysconf("SC_PAGESIZE") / 2**20, len(list((process / "fd").iterdir())), int(fields[17]), used)


def children(pid: int) -> list[int]:
    """Return the processes that a process has started."""
    found = []
    for task in Path(f"/proc/{pid}/task").iterdir():
        found += [int(each) for each in (task / "children").read_text().split()]
    return sorted(found)


class Visitors:
    """Programs that come to the doors, want an answer, and go.

    Args:
        text: port of the text server.
        watch: port of the watch server; 0: there is none.
    """

    def __init__(self, text: int, watch: int) -> None:
        self.longest = 0.0
        self.failed = 0
        self.visits = 0
        self._text = text
        self._watch = watch

    def visit(self) -> None:
        """Visit each door once, and note how long the text server had us wait."""
        self.visits += 1
        try:
            with socket.create_connection((HOST, self._text), 30.0) as client:
                client.sendall(f"%%setid Visitor{self.visits}\n".encode())
                began = time.monotonic()
                client.sendall(b"%%ping\n")
                heard = b""
                while b"%%pong" not in heard:
                    heard += received(client)
                self.longest = max(self.longest, time.monotonic() - began)
            if self._watch:
                with socket.create_connection((HOST, self._watch), 30.0) as client:
                    received(client)
        except OSError:
            self.failed += 1


def received(client: socket.socket) -> bytes:
    """Wait for bytes. Raises OSError where none come any more."""
    data = client.recv(2**16)
    if not data:
        raise ConnectionError
    return data


class Recorded:
    """What a run has recorded: journals, and bags whose finished pieces are removed so that the disk holds a day.

    Args:
        folder: of the run.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._removed = 0.0

    def sizes(self) -> tuple[float, float]:
        """Return the megabytes of all journals and of all bags so far."""
        journals = [path.stat().st_size for path in self._folder.rglob("*.jsonl")]
        bags = sorted(self._folder.glob("*.bag*"), key=lambda path: path.stat().st_mtime)
        held = [path.stat().st_size for path in bags]
        for path, size in zip(bags[:-2], held[:-2], strict=True):
            self._removed += size / 2**20
            path.unlink()
        return sum(journals) / 2**20, self._removed + sum(held[-2:]) / 2**20  # of integers


class Sampler:
    """Writes a row of figures now and then.

    Args:
        folder: of the run.
        processes: their ids by their names.
        visitors: whose waits are written.
    """

    def __init__(self, folder: Path, processes: Mapping[str, int], visitors: Visitors) -> None:
        self._folder = folder
        self._processes = processes
        self._visitors = visitors
        self._recorded = Recorded(folder)
        self._began = time.monotonic()
        self._file = (folder / "samples.csv").open("w", newline="")
        self._writer: csv.DictWriter[str] | None = None

    def told(self, companion: str) -> dict[str, int]:
        """Return the latest report of a companion."""
        try:
            return dict(json.loads((self._folder / f"{companion}.json").read_text()))
        except FileNotFoundError:
            return {}

    def sample(self) -> dict[str, float]:
        """Write a row, and return it."""
        journals, bags = self._recorded.sizes()
        player, watcher = self.told("participant"), self.told("watcher")
        row: dict[str, float] = {
            "wall_s": round(time.monotonic() - self._began, 1),
            "sim_s": watcher.get("stamp_ms", 0) / 1000.0,
            "games": player.get("over", 0),
            "journals_MB": round(journals, 3),
            "bags_MB": round(bags, 1),
            "longest_wait_ms": round(1000.0 * self._visitors.longest, 1),
            "visits": self._visitors.visits,
            "failed_visits": self._visitors.failed,
            "dropped": watcher.get("dropped", 0),
            "lost": sum(self.told(each).get("lost", 0) for each in COMPANIONS),  # of integers
            "ros_messages": self.told("node").get("messages", 0),
            "ros_nodes_passed": self.told("node").get("passed", 0),
            "mavlink_frames": self.told("station").get("frames", 0),
            "mavlink_parameters": self.told("station").get("parameters", 0),
            "mavlink_trips": self.told("station").get("trips", 0),
        }
        for name, pid in self._processes.items():
            load = load_of(pid)
            row[f"{name}_MB"] = round(load.memory, 2)
            row[f"{name}_descriptors"] = load.descriptors
            row[f"{name}_threads"] = load.threads
            row[f"{name}_cpu_s"] = round(load.processor, 2)
        self._visitors.longest = 0.0
        if self._writer is None:
            self._writer = csv.DictWriter(self._file, list(row))
            self._writer.writeheader()
        self._writer.writerow(row)
        self._file.flush()
        return row


# Runs


STUDY = """\
map: {map}
templates: original-2016
robots: {robots}
seed: 3
recording:
  split_size: 200
mavlink:
  lost_after: 600
participant:
  sound: false
game:
  energy: {energy}
"""
"""A finished piece of 200 MB is removed; ground stations go by wall time, a day here takes an hour or two."""


class Running:
    """The programs of a run, ended with it."""

    def __init__(self, folder: Path, opened: ExitStack, environment: Mapping[str, str]) -> None:
        self.folder = folder
        self._opened = opened
        self._environment = environment

    def start(self, name: str, *words: str) -> subprocess.Popen[bytes]:
        """Start a program whose output goes to a file."""
        told = self._opened.enter_context((self.folder / f"{name}.txt").open("wb"))
        process = subprocess.Popen(
            words, cwd=self.folder, stdout=told, stderr=told, stdin=subprocess.DEVNULL, env=self._environment
        )
        self._opened.callback(end, process)
        return process

    def thbridge(self, name: str, *words: str) -> subprocess.Popen[bytes]:
        """Start a program of ours."""
        return self.start(name, *THBRIDGE, *words)

    def companion(self, name: str, *words: str) -> subprocess.Popen[bytes]:
        """Start a companion."""
        script = str(Path(__file__).resolve())
        return self.start(name, sys.executable, script, "companion", name, "--folder", str(self.folder), *words)

    def wait(self, name: str, words: str, process: subprocess.Popen[bytes]) -> None:
        """Wait until a program has said so. Raises RuntimeError: it does not."""
        path, until = self.folder / f"{name}.txt", time.monotonic() + PATIENCE
        while words not in path.read_text(errors="replace"):
            if process.poll() is not None or time.monotonic() > until:
                raise RuntimeError(f"{name} does not say {words!r}:\n{path.read_text(errors='replace')[-2000:]}")
            time.sleep(0.1)


def end(process: subprocess.Popen[bytes]) -> None:
    """End a program in good order."""
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(90)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def free_ports(count: int) -> list[int]:
    """Ports that nobody listens at."""
    sockets = [socket.create_server((HOST, 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


@contextlib.contextmanager
def x_server() -> Iterator[str]:
    """An X server without a screen; its DISPLAY."""
    reading, writing = os.pipe()
    words = ["Xvfb", "-displayfd", str(writing), "-screen", "0", "1280x860x24", "-nolisten", "tcp", "-noreset"]
    server = subprocess.Popen(words, pass_fds=(writing,), stderr=subprocess.DEVNULL)
    os.close(writing)
    with os.fdopen(reading) as answer:
        place = answer.readline().strip()
    try:
        yield f":{place}"
    finally:
        end(server)


def begin_game(environment: Mapping[str, str]) -> None:
    """Press the usual button of the window's start page."""

    def do(*words: str) -> str:
        return subprocess.run(
            ["xdotool", *words], env=environment, capture_output=True, text=True, check=False
        ).stdout.strip()

    until = time.monotonic() + PATIENCE
    while not (window := do("search", "--onlyvisible", "--name", "^Treasure hunt").split("\n")[-1]):
        if time.monotonic() > until:
            raise RuntimeError("the participant's window does not open")
        time.sleep(0.2)
    do("windowfocus", "--sync", window)
    time.sleep(2.0)
    do("key", "Return")


def run_session(given: argparse.Namespace, opened: ExitStack, environment: dict[str, str]) -> None:
    """Run `thbridge play` with everybody connected."""
    environment["DISPLAY"] = opened.enter_context(x_server())
    running = Running(given.folder, opened, environment)
    text, door, tcp, ros = free_ports(4)
    (given.folder / "study.yaml").write_text(STUDY.format(robots=given.robots, map=given.map, energy=given.energy))
    words = ["play", "study.yaml", "--rate", "0", "--bag", "hunt.bag", "--no-report", "--port", str(text)]
    words += ["--watch", str(door), "--ros", "--ros-master", f"http://{HOST}:{ros}"]
    words += ["--mavlink", "--tcp", f"{HOST}:{tcp}", "--max-seconds", str(DAY * 10)]
    program = running.thbridge("session", *words)
    begin_game(environment)
    running.wait("session", "join at", program)
    robots = ["--robots", str(given.robots)]
    companions = {
        "participant": running.companion("participant", "--text", str(text), "--name", "Simulated"),
        "watcher": running.companion("watcher", "--watch", str(door), *robots),
        "node": running.companion("node", "--ros", str(ros), *robots),
        "station": running.companion("station", "--mavlink", str(tcp), *robots),
    }
    processes = {"session": program.pid, "window": children(program.pid)[-1]}
    processes |= {name: process.pid for name, process in companions.items()}
    # The session needs a core of its own; all others take what is left.
    for name, pid in processes.items():
        if name != "session":
            os.setpriority(os.PRIO_PROCESS, pid, 5)
    sample_until(given, processes, Visitors(text, door), program)


def run_server(given: argparse.Namespace, opened: ExitStack, environment: dict[str, str]) -> None:
    """Run `thbridge server` with robots and treasures, and games one after the other."""
    running = Running(given.folder, opened, environment)
    text, door = free_ports(2)
    (given.folder / "study.yaml").write_text(STUDY.format(robots=given.robots, map=given.map, energy=given.energy))
    server = running.thbridge("server", "server", "study.yaml", "--port", str(text), "--journal", "journal")
    running.wait("server", "listening on", server)
    at = ["--server", f"{HOST}:{text}"]
    robots = running.thbridge("robots", "simr", "study.yaml", *at, "--rate", "10000", "--watch", str(door))
    hider = running.thbridge("hider", "hider", "study.yaml", *at)
    running.wait("robots", "connected", robots)
    player = running.companion("participant", "--text", str(text), "--name", legacy.TABUI)
    watcher = running.companion("watcher", "--watch", str(door), "--robots", str(given.robots))
    processes = {"server": server.pid, "robots": robots.pid, "hider": hider.pid}
    processes |= {"participant": player.pid, "watcher": watcher.pid}
    sample_until(given, processes, Visitors(text, door), server)


def sample_until(
    given: argparse.Namespace, processes: Mapping[str, int], visitors: Visitors, program: subprocess.Popen[bytes]
) -> None:
    """Take samples until the simulated day, or the time for it, is over."""
    sampler = Sampler(given.folder, processes, visitors)
    began = sampled = time.monotonic()
    row: Mapping[str, float] = sampler.sample()
    while time.monotonic() - began < given.minutes * 60 and row["sim_s"] < given.hours * 3600:
        if program.poll() is not None:
            raise RuntimeError("the program has ended by itself; see its output")
        visitors.visit()
        time.sleep(PASSES / 5)
        if time.monotonic() - sampled >= given.every:
            sampled = time.monotonic()
            row = sampler.sample()
            print(json.dumps(row), flush=True)


# What has grown


WARM_UP = 0.2
"""Share of a run after which growth is looked for: by then caches are full, and allocators have their arenas."""
TREND = 5
"""Fewest samples of which a trend is made."""


@dataclass(frozen=True, slots=True)
class Bound:
    """Most that a figure may grow within a simulated hour, after the warm-up; `slack`: within the whole run besides."""

    growth: float
    slack: float


BOUNDS: Mapping[str, Bound] = {
    "MB": Bound(1.0, 4.0),
    "descriptors": Bound(0.0, 4.0),
    "threads": Bound(0.0, 1.0),
}
"""By the ends of columns' names. A day may cost a process some megabytes: the outcomes of games are kept for its end."""
SLOWER = 1.25
"""Most that a tick's processor time may be in the second half of what follows the warm-up, as a share of the first."""
RECORDED = ("journals", "bags")


@dataclass(frozen=True, slots=True)
class Growth:
    """Growth of a column: units a simulated hour, with a 95 % interval; the most of it that is allowed in this run."""

    column: str
    begun: float
    ended: float
    hourly: float
    low: float
    high: float
    allowed: float

    @property
    def is_beyond(self) -> bool:
        """True where even the lower end of the interval is beyond the bound."""
        return self.low > self.allowed


class Samples:
    """The samples of a run.

    Args:
        path: of its CSV file.
    """

    def __init__(self, path: Path) -> None:
        with path.open(newline="") as file:
            rows = list(csv.DictReader(file))
        self.columns = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}
        self.hours = self.columns["sim_s"] / 3600.0
        self.warm = self.hours >= WARM_UP * self.hours[-1]

    @property
    def processes(self) -> list[str]:
        """Names of the processes."""
        return [name.removesuffix("_threads") for name in self.columns if name.endswith("_threads")]

    def growth(self, column: str, bound: Bound) -> Growth:
        """Return the growth of a column, by Theil and Sen's median of slopes, which single samples do not move."""
        hours, values = self.hours[self.warm], self.columns[column][self.warm]
        hourly, _, low, high = stats.theilslopes(values, hours)
        allowed = bound.growth + bound.slack / max(hours[-1] - hours[0], 1e-9)
        return Growth(column, values[0], values[-1], hourly, low, high, allowed)

    def all_growth(self) -> list[Growth]:
        """Return the growth of all that must not grow."""
        return [self.growth(f"{process}_{end}", bound) for process in self.processes for end, bound in BOUNDS.items()]

    def tick_milliseconds(self, process: str) -> FloatArray:
        """Return the processor time of a tick between each two samples."""
        used, passed = np.diff(self.columns[f"{process}_cpu_s"]), np.diff(self.columns["sim_s"])
        return 1000.0 * used * TICK / np.where(passed > 0.0, passed, np.nan)

    def slowdown(self, process: str) -> float:
        """Return the processor time of a tick in the second half after the warm-up, of that in the first."""
        times = self.tick_milliseconds(process)[self.warm[1:]]
        half = len(times) // 2
        return float(np.nanmedian(times[half:]) / np.nanmedian(times[:half]))


def judge(samples: Samples) -> bool:
    """Print what has grown; return True where nothing is beyond its bound."""
    columns, main = samples.columns, samples.processes[0]
    if np.count_nonzero(samples.warm) < TREND:
        print("The run was too short for a trend.")
        return False
    last = {name: values[-1] for name, values in columns.items()}
    print(
        f"{samples.hours[-1]:.2f} simulated hours and {last['games']:.0f} games in {last['wall_s'] / 60:.0f} minutes; "
        f"{last['visits']:.0f} visits at the doors, {last['failed_visits']:.0f} in vain, {last['lost']:.0f} "
        f"connections lost, {last['dropped']:.0f} messages dropped for the watcher; {last['ros_messages']:.0f} messages by ROS, "
        f"{last['mavlink_frames']:.0f} frames by MAVLink, {last['mavlink_trips']:.0f} trips of the station."
    )
    print(f"{'':<24} {'first':>9} {'last':>9} {'an hour':>9}  {'95 % interval':<20} {'allowed':>9}")
    grown = samples.all_growth()
    for each in grown:
        interval = f"{each.low:.3f} to {each.high:.3f}"
        verdict = "GROWS" if each.is_beyond else ""
        print(
            f"{each.column:<24} {each.begun:>9.1f} {each.ended:>9.1f} {each.hourly:>9.3f}  {interval:<20} "
            f"{each.allowed:>9.3f}  {verdict}"
        )
    for name in RECORDED:
        each = samples.growth(f"{name}_MB", Bound(0.0, 0.0))
        print(f"{each.column:<24} {each.begun:>9.1f} {each.ended:>9.1f} {each.hourly:>9.3f}  (recorded)")
    slower = samples.slowdown(main)
    times = samples.tick_milliseconds(main)[samples.warm[1:]]
    verdict = "SLOWER" if slower > SLOWER else ""
    print(
        f"A tick takes {main} {np.nanmedian(times):.2f} ms of processor time; {slower:.2f} times as much in the second "
        f"half as in the first, {SLOWER} are allowed.  {verdict}"
    )
    return slower <= SLOWER and not any(each.is_beyond for each in grown) and not last["failed_visits"]


def draw(samples: Samples, path: Path) -> None:
    """Draw the curves, with the trends of what must not grow."""
    figure, axes = plt.subplots(3, 2, figsize=(10.0, 10.5), sharex=True, layout="constrained")
    hours, main = samples.hours, samples.processes[0]
    for panel, (end, title) in zip(
        axes.flat,
        (("MB", "resident memory, MB"), ("descriptors", "open descriptors"), ("threads", "threads")),
        strict=False,
    ):
        for number, process in enumerate(samples.processes):
            column, colour = f"{process}_{end}", f"C{number}"
            trend = samples.growth(column, BOUNDS[end])
            panel.plot(hours, samples.columns[column], colour, lw=1.2, label=f"{process}: {trend.hourly:+.2f} an hour")
            values, warm = samples.columns[column][samples.warm], hours[samples.warm]
            middle = np.median(values) - trend.hourly * np.median(warm)
            panel.plot(warm, middle + trend.hourly * warm, colour, ls=":", lw=1.2)
        panel.set_title(title, loc="left", fontsize=10)
        panel.set_ylim(bottom=0.0)
        panel.legend(fontsize=7)
    panel = axes.flat[3]
    panel.plot(hours[1:], samples.tick_milliseconds(main), "C0", lw=1.2)
    panel.set_title(f"processor time of {main} for a tick, ms", loc="left", fontsize=10)
    panel.set_ylim(bottom=0.0)
    panel = axes.flat[4]
    panel.plot(hours[1:], samples.columns["longest_wait_ms"][1:], "C0", lw=1.2)
    panel.set_title("longest wait of a visitor for %%pong since the sample before, ms", loc="left", fontsize=10)
    panel.set_ylim(bottom=0.0)
    panel = axes.flat[5]
    panel.plot(hours, samples.columns["games"], "C0", lw=1.2, label="games")
    panel.plot(hours, samples.columns["journals_MB"], "C1", lw=1.2, label="journals, MB")
    panel.plot(hours, samples.columns["bags_MB"] / 1024.0, "C2", lw=1.2, label="bag, GB")
    panel.set_title("games, and what is recorded of them", loc="left", fontsize=10)
    panel.set_ylim(bottom=0.0)
    panel.legend(fontsize=7)
    for panel in axes[-1]:
        panel.set_xlabel("simulated hours")
    for panel in axes.flat:
        panel.axvspan(0.0, WARM_UP * hours[-1], color="0.93", lw=0.0)
        panel.grid(color="0.9")
    figure.savefig(path, dpi=100)


def main() -> int:
    """Run what the command line says."""
    parser = argparse.ArgumentParser(description=__doc__)
    kinds = parser.add_subparsers(dest="kind", required=True)
    for kind, robots, energy in (("session", 6, 100), ("server", 2, 30)):
        runs = kinds.add_parser(kind)
        runs.add_argument("--robots", type=int, default=robots)
        runs.add_argument("--energy", type=float, default=energy, help="of a robot; with less, games are shorter")
        runs.add_argument("--map", default="arena8")
        runs.add_argument("--hours", type=float, default=24.0, help="simulated")
        runs.add_argument("--minutes", type=float, default=600.0, help="of wall time, at most")
        runs.add_argument("--every", type=float, default=60.0, help="seconds of wall time between two samples")
        runs.add_argument("--folder", type=Path, default=Path("long-run"))
        runs.add_argument("--to", type=Path, help="picture of the curves")
    drawn = kinds.add_parser("plot")
    drawn.add_argument("samples", type=Path)
    drawn.add_argument("--to", type=Path, help="picture of the curves")
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


def run(given: argparse.Namespace) -> None:
    """Run what is to be sampled."""
    given.folder = given.folder.resolve()
    shutil.rmtree(given.folder, ignore_errors=True)
    given.folder.mkdir(parents=True)
    home = given.folder / "home"
    environment = {**os.environ, "PYTHONPATH": str(Path.cwd()), "XDG_CONFIG_HOME": str(home), "PYTHONUNBUFFERED": "1"}
    environment.pop("QT_QPA_PLATFORM", None)
    with ExitStack() as opened:
        (run_session if given.kind == "session" else run_server)(given, opened, environment)


if __name__ == "__main__":
    sys.exit(main())
