"""What a call of the master costs, beside rosmaster; the same client asks both, one call after the other."""

import os
import shutil
import socket
import subprocess
import sys
import time
import xmlrpc.client
from pathlib import Path

import pytest

from tests.bench.budget import Budgets

pytestmark = [
    pytest.mark.bench,
    pytest.mark.skipif(shutil.which("rosmaster") is None, reason="Debian's python3-rosmaster is not installed"),
]

CALLS = 1000
NODES = 50
ROUNDS = 3
OURS = [sys.executable, "-c", "from ui.cli import main; main()", "ros", "master", "--port"]
THEIRS = ["rosmaster", "--core", "-p"]


def measured(command: list[str]) -> dict[str, float]:
    """Microseconds of the master's processor time per call, by what is called."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    process = subprocess.Popen([*command, str(port)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        with xmlrpc.client.ServerProxy(f"http://127.0.0.1:{port}/") as master:
            while True:
                try:
                    master.getUri("/bench")
                    break
                except OSError:
                    time.sleep(0.1)
            # Publishers only: subscribers would have to be there to be told.
            registering = [
                (
                    "registerPublisher",
                    f"/n{number % NODES}",
                    f"/t{number}",
                    "a/B",
                    f"http://127.0.0.1:{number % NODES}/",
                )
                for number in range(CALLS)
            ]
            asked = {
                "registerPublisher": registering,
                "setParam": [("setParam", "/bench", f"/p/{number % 100}/value", number) for number in range(CALLS)],
                "getParam": [("getParam", "/bench", f"/p/{number % 100}/value") for number in range(CALLS)],
                "getSystemState": [("getSystemState", "/bench")] * 50,
            }
            return {name: _cost(process.pid, master, calls) for name, calls in asked.items()}
    finally:
        process.kill()
        process.wait()


def _cost(pid: int, master: xmlrpc.client.ServerProxy, calls: list[tuple[object, ...]]) -> float:
    before = _processor_seconds(pid)
    for method, *params in calls:
        status, _, _ = getattr(master, str(method))(*params)
        assert status == 1
    return (_processor_seconds(pid) - before) / len(calls) * 1e6


def _processor_seconds(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def test_calls_of_the_master(budgets: Budgets) -> None:
    best: dict[str, dict[str, float]] = {"ours": {}, "rosmaster": {}}
    for _ in range(ROUNDS):
        for who, command in (("ours", OURS), ("rosmaster", THEIRS)):
            for name, cost in measured(command).items():
                best[who][name] = min(cost, best[who].get(name, cost))
    print(f"\n{CALLS} calls of one client; {NODES} nodes that publish {CALLS} topics; processor time of the master")
    for name in best["ours"]:
        ours, theirs = best["ours"][name], best["rosmaster"][name]
        print(f"  {name:18} ours {ours:7.0f} us, rosmaster {theirs:7.0f} us, ratio {ours / theirs:.2f}")
        budgets.ratio(f"master: {name}, beside rosmaster", ours / theirs)
