"""MAVProxy, without a screen and in a folder of its own: modes, arming, guided, missions, parameters.

It has several hundred commands; what is done here is what the manual of its rover begins with.
"""

import os
import re
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.peers.rovers import PEERS, degrees, free_udp_port, needs, rovers
from tests.system.programs import Program

pytestmark = needs("mavproxy")

MODULES = "link,param,wp,mode,cmdlong,arm,log,signing,misc"
PATIENCE = 60.0
PARAMETER = "SIM_ODOM_ALPHA1"


class MavProxy:
    """One MAVProxy, typed to line by line."""

    def __init__(self, folder: Path, port: int) -> None:
        self.folder = folder
        self.output = folder / "mavproxy.txt"
        self._file = self.output.open("wb")
        self._read = 0
        self.process = subprocess.Popen(
            [
                PEERS / "mavproxy" / "bin" / "mavproxy.py", f"--master=udp:127.0.0.1:{port}",
                f"--default-modules={MODULES}", "--target-system=1", f"--state-basedir={folder}", "--nowait",
            ],
            cwd=folder, stdin=subprocess.PIPE, stdout=self._file, stderr=subprocess.STDOUT, text=True, bufsize=1,
            env={**os.environ, "PYTHONUNBUFFERED": "1", "HOME": str(folder)}, start_new_session=True,
        )  # fmt: skip

    def types(self, line: str) -> None:
        assert self.process.stdin is not None
        self.process.stdin.write(f"{line}\n")

    def says(self, pattern: str, again: str = "") -> re.Match[str]:
        """Waits for words that it has not said before, and takes all up to them as read.

        What is typed `again` each second may lead to them.
        """
        end, typed = time.monotonic() + PATIENCE, time.monotonic()
        while True:
            text = self.output.read_text(errors="replace")
            found = re.search(pattern, text[self._read :])
            if found is not None:
                self._read += found.end()
                return found
            if time.monotonic() > end:
                raise TimeoutError(f"waited {PATIENCE} s for {pattern!r} in\n{text}")
            if again and time.monotonic() > typed + 1.0:
                typed = time.monotonic()
                self.types(again)
            time.sleep(0.05)

    def does(self, line: str, pattern: str) -> re.Match[str]:
        self.types(line)
        return self.says(pattern)

    def close(self) -> None:
        if self.process.poll() is None:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait(10)
        if self.process.stdin is not None:
            self.process.stdin.close()
        self._file.close()


@contextmanager
def beside(folder: Path) -> Iterator[tuple[MavProxy, Program]]:
    port = free_udp_port()
    with rovers(folder, (port,), "--identity", "ardupilot") as play:
        (folder / "mavproxy").mkdir()
        proxy = MavProxy(folder / "mavproxy", port)
        try:
            yield proxy, play
        finally:
            proxy.close()


@pytest.fixture(scope="module")
def proxy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[MavProxy]:
    with beside(tmp_path_factory.mktemp("mavproxy")) as (proxy, _):
        proxy.says(r"Received \d+ parameters")
        yield proxy


def test_all_robots_are_detected(proxy: MavProxy) -> None:
    told = proxy.output.read_text()
    assert all(f"Detected vehicle {system}:1 on link 0" in told for system in (1, 2, 3))


def test_a_parameter_is_shown_set_and_a_wrong_one_refused(proxy: MavProxy) -> None:
    before = float(proxy.does(f"param show {PARAMETER}", rf"{PARAMETER}\s+([\d.]+)")[1])
    proxy.types(f"param set {PARAMETER} {before + 0.25}")
    proxy.says(rf"{PARAMETER} = {before + 0.25:.4f}", again=f"param fetch {PARAMETER}")
    kept = rf"Failed to set {PARAMETER} to -7 \(invalid returned value {before + 0.25:.2f}"
    proxy.does(f"param set {PARAMETER} -7", kept)


def test_it_is_armed_guided_to_a_point_and_held(proxy: MavProxy) -> None:
    proxy.does("arm throttle", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED")
    proxy.says("ARMED")
    proxy.does("mode GUIDED", "Mode GUIDED")
    latitude, longitude = degrees(0.0, 1.2)
    proxy.does(f"guided {latitude:.7f} {longitude:.7f} 0", "Got COMMAND_ACK: DO_REPOSITION: ACCEPTED")
    proxy.says(r"x : 1\.\d+, y : -?0\.\d+, z", again="status LOCAL_POSITION_NED")  # the others are elsewhere
    proxy.does("mode HOLD", "Mode HOLD")
    proxy.does("disarm", "DISARMED")


def test_a_mission_is_loaded_listed_run_and_cleared(proxy: MavProxy) -> None:
    places = [degrees(0.0, 0.0), degrees(0.0, 0.6), degrees(0.3, 0.3)]
    lines = [
        f"{seq}\t{int(seq == 0)}\t{3 if seq else 0}\t16\t0\t0\t0\t0\t{place[0]:.8f}\t{place[1]:.8f}\t0\t1"
        for seq, place in enumerate(places)
    ]
    plan = proxy.folder / "plan.txt"
    plan.write_text("\n".join(["QGC WPL 110", *lines]) + "\n")
    proxy.does(f"wp load {plan}", "Got MISSION_ACK: TYPE_MISSION: ACCEPTED")
    proxy.does("wp list", "Requesting 3 waypoints")
    for place in places[1:]:
        found = proxy.says(r"16 3 (-?[\d.]+) (-?[\d.]+) ")
        assert (float(found[1]), float(found[2])) == pytest.approx(place, abs=2e-7)
    proxy.does("arm throttle", "ARMED")
    proxy.does("mode AUTO", "AUTO> ")
    proxy.says("waypoint 2")
    proxy.says("Mission complete")
    proxy.says("HOLD> ")
    proxy.does("wp clear", "Got MISSION_ACK: TYPE_MISSION: ACCEPTED")
    proxy.does("wp list", "Requesting 0 waypoints")
    proxy.does("disarm", "DISARMED")


def test_another_robot_is_chosen(proxy: MavProxy) -> None:
    proxy.does("vehicle 3", "Set vehicle 3")
    proxy.does("arm throttle", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED")
    proxy.does("disarm", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED")
    proxy.does("vehicle 1", "Set vehicle 1")
