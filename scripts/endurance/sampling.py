"""Samples of the resources of programs, read from /proc, and test connections to the programs' ports."""

import csv
import json
import os
import socket
import time
from collections.abc import Mapping
from pathlib import Path

HOST = "127.0.0.1"
YARDSTICK = 200_000
"""Number of rounds of a fixed computation. The computation takes some tens of milliseconds."""
PATIENCE = 30.0
"""Timeout of a visitor, seconds."""


def load_of(pid: int) -> dict[str, float]:
    """Return the resources and processor seconds that a process uses now. Raise OSError if it has ended."""
    process = Path(f"/proc/{pid}")
    pages = int((process / "statm").read_text().split()[1])
    fields = (process / "stat").read_text().rpartition(")")[2].split()
    return {
        "MB": round(pages * os.sysconf("SC_PAGESIZE") / 2**20, 2),
        "descriptors": len(list((process / "fd").iterdir())),
        "threads": int(fields[17]),
        "cpu_s": (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"),
    }


def yardstick() -> float:
    """Return the processor time of a fixed computation, ms.

    It shows how slow the processor is at the moment, because a core is slower if other cores are busy.
    """
    began = time.thread_time()
    for number in range(YARDSTICK):
        str(number)
    return 1000.0 * (time.thread_time() - began)


class Visitors:
    """Short-lived clients that connect to the ports, wait for an answer, and leave.

    Args:
        text: port of the text server.
        watch: port of the watch server.
    """

    def __init__(self, text: int, watch: int) -> None:
        self.longest = 0.0
        self.failed = 0
        self.visits = 0
        self._text = text
        self._watch = watch

    def visit(self) -> None:
        """Connect to each port once, and record how long the text server took to answer."""
        self.visits += 1
        try:
            with socket.create_connection((HOST, self._text), PATIENCE) as client:
                client.sendall(f"%%setid Visitor{self.visits}\n".encode())
                began = time.monotonic()
                client.sendall(b"%%ping\n")
                heard = b""
                while b"%%pong" not in heard:
                    heard += received(client)
                self.longest = max(self.longest, time.monotonic() - began)
            with socket.create_connection((HOST, self._watch), PATIENCE) as client:
                received(client)
        except OSError:
            self.failed += 1


def received(client: socket.socket) -> bytes:
    """Wait for bytes. Raise OSError if the connection is closed."""
    data = client.recv(2**16)
    if not data:
        raise ConnectionError
    return data


class Recorded:
    """Recordings of a run: journals and bags. Finished parts of bags are deleted, so that the disk does not fill up."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._removed = 0

    def megabytes(self) -> tuple[float, float]:
        """Return the size of all journals, and of all bags so far, in megabytes."""
        journals = [path.stat().st_size for path in self._folder.rglob("*.jsonl")]
        bags = sorted(self._folder.glob("*.bag*"), key=lambda path: path.stat().st_mtime)
        for path in bags[:-2]:
            self._removed += path.stat().st_size
            path.unlink()
        held = [path.stat().st_size for path in bags[-2:]]
        return sum(journals) / 2**20, (self._removed + sum(held)) / 2**20  # sums of integers


class Sampler:
    """Writer of periodic rows of figures.

    Args:
        folder: folder of the run.
        processes: process ids, by name.
        visitors: visitors, whose waiting times are recorded.
    """

    def __init__(self, folder: Path, processes: Mapping[str, int], visitors: Visitors) -> None:
        self._folder = folder
        self._processes = processes
        self._visitors = visitors
        self._recorded = Recorded(folder)
        self._began = time.monotonic()
        self._written = False

    def sample(self) -> dict[str, float]:
        """Write a row, and return it."""
        journals, bags = self._recorded.megabytes()
        player, watcher, node, station = map(self._latest, ("participant", "watcher", "node", "station"))
        row: dict[str, float] = {
            "wall_s": round(time.monotonic() - self._began, 1),
            "sim_s": watcher.get("stamp_ms", 0) / 1000.0,
            "games": player.get("over", 0),
            "journals_MB": round(journals, 3),
            "bags_MB": round(bags, 1),
            "longest_wait_ms": round(1000.0 * self._visitors.longest, 1),
            "visits": self._visitors.visits,
            "failed_visits": self._visitors.failed,
            "yardstick_ms": round(yardstick(), 2),
            "dropped": watcher.get("dropped", 0),
            "lost": player.get("lost", 0) + watcher.get("lost", 0),
            "ros_messages": node.get("messages", 0),
            "ros_nodes_passed": node.get("passed", 0),
            "mavlink_frames": station.get("frames", 0),
            "mavlink_trips": station.get("trips", 0),
        }
        for name, pid in self._processes.items():
            row |= {f"{name}_{what}": value for what, value in load_of(pid).items()}
        self._visitors.longest = 0.0
        with (self._folder / "samples.csv").open("a", newline="") as file:
            writer = csv.DictWriter(file, list(row))
            if not self._written:
                writer.writeheader()
            writer.writerow(row)
        self._written = True
        return row

    def _latest(self, companion: str) -> dict[str, int]:
        """Return the latest report of a companion."""
        try:
            return dict(json.loads((self._folder / f"{companion}.json").read_text()))
        except FileNotFoundError:
            return {}
