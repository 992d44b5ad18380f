"""Attack a session that runs on this machine, and tell how it held: every door, the loopback alone, bounded.

Run it from the project's folder: `.venv/bin/python scripts/attack.py` (`make attack`). It starts a hunt with all doors
open, lets one attack after the other loose on it, and measures meanwhile how long an honest program waits for an
answer, what memory and descriptors the session takes, and whether it still runs. Ends with 1 where something gave way.
"""

import argparse
import asyncio
import contextlib
import json
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

from thbridge.protocols.mavlink.dialect import mav
from thbridge.protocols.watching import BagStreamReader, SessionMessage, key_line, parse_status

HOST = "127.0.0.1"
PATIENCE = 10.0
WAIT_BOUND = 1.0
"""Longest wait of honest people, and lag of the session, seconds, that counts as held."""
MEMORY_BOUND = 256
"""Megabytes that one attack may cost."""
KEY = "attack-" + "0123456789abcdef"


@dataclass(frozen=True, slots=True)
class Doors:
    """Ports of the session's doors."""

    text: int
    watch: int
    tcp: int
    udp: int
    ros: int


class Honest(threading.Thread):
    """Honest people beside an attack: a program that wants answers, and a researcher who comes again and again.

    Attributes:
        wait: longest time until either was served since it was last set, seconds.
        lag: how far the session is behind its pace, seconds; what it does not make up for stays in it.
        refused: how often either was cut off or kept out.
    """

    def __init__(self, doors: "Doors") -> None:
        super().__init__(daemon=True)
        self.wait = self.lag = 0.0
        self.refused = 0
        self._doors = doors
        self._stopped = threading.Event()
        self._client: socket.socket | None = None

    def run(self) -> None:
        """Ask both doors ten times a second, until stopped."""
        while not self._stopped.wait(0.1):
            for ask in (self._ping, self._watch):
                began = time.monotonic()
                try:
                    ask()
                except OSError:
                    self.refused += 1
                    self._client = None
                self.wait = max(self.wait, time.monotonic() - began)

    def stop(self) -> None:
        """Ask no more."""
        self._stopped.set()
        self.join(30)

    def _ping(self) -> None:
        if self._client is None:
            self._client = socket.create_connection((HOST, self._doors.text), PATIENCE)
            self._client.sendall(b"%%setid Honest\n")
        self._client.sendall(b"%%ping\n")
        heard = b""
        while b"%%pong" not in heard:
            heard += received(self._client)

    def _watch(self) -> None:
        stream = BagStreamReader()
        with socket.create_connection((HOST, self._doors.watch), PATIENCE) as client:
            client.sendall(key_line(KEY))
            while True:
                for message in stream.feed(received(client)):
                    status = parse_status(message) if isinstance(message, SessionMessage) else None
                    if status is not None:
                        if status.refused is not None:
                            raise ConnectionError
                        self.lag = status.lag
                        return


def received(client: socket.socket) -> bytes:
    """Wait for bytes. Raises OSError where none come any more."""
    data = client.recv(2**18)
    if not data:
        raise ConnectionError
    return data


async def connections(port: int, count: int) -> list[asyncio.StreamWriter]:
    """Open as many connections as are accepted."""
    writers = []
    for _ in range(count):
        with contextlib.suppress(OSError):
            writers.append((await asyncio.open_connection(HOST, port))[1])
    return writers


async def say(port: int, data: bytes, times: int = 1, count: int = 1, seconds: float = 5.0) -> int:
    """Say the same again and again on some connections, until it is said or the time is up; return how often."""
    said = 0

    async def one() -> None:
        nonlocal said
        with contextlib.suppress(OSError, asyncio.CancelledError):
            _, writer = await asyncio.open_connection(HOST, port)
            try:
                for _ in range(times):
                    writer.write(data)
                    await writer.drain()
                    said += 1
            finally:
                writer.close()

    tasks = [asyncio.create_task(one()) for _ in range(count)]
    _, late = await asyncio.wait(tasks, timeout=seconds)
    for task in late:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)
    return said


async def idle(port: int, count: int) -> int:
    """Hold silent connections for a while."""
    writers = await connections(port, count)
    await asyncio.sleep(2.5)
    for writer in writers:
        writer.close()
    return count


async def turned_away(port: int, count: int) -> int:
    """Open connections one after the other and close none of them before all are open."""
    clients = []
    for _ in range(count):
        client = socket.socket()
        client.setblocking(False)
        with contextlib.suppress(BlockingIOError, OSError):
            client.connect((HOST, port))
        clients.append(client)
        if len(clients) > 400:
            clients.pop(0).close()
        await asyncio.sleep(0)
    for client in clients:
        client.close()
    return count


async def noise(port: int, draws: random.Random) -> int:
    """Say random bytes."""
    return await say(port, draws.randbytes(8192), 20, 20)


def http(path: str, body: str, headers: str = "") -> bytes:
    """Return a request as a page in a browser makes it."""
    return f"POST {path} HTTP/1.1\r\nHost: {HOST}\r\n{headers}Content-Length: {len(body)}\r\n\r\n{body}".encode()


def xmlrpc(method: str, *arguments: str) -> bytes:
    """Return a call of the ROS master."""
    values = "".join(f"<param><value><string>{argument}</string></value></param>" for argument in arguments)
    body = f"<?xml version='1.0'?><methodCall><methodName>{method}</methodName><params>{values}</params></methodCall>"
    return http("/RPC2", body, "Content-Type: text/xml\r\n")


async def subscribers(port: int, count: int) -> int:
    """Register invented subscribers of one topic."""
    for number in range(count):
        uri = f"http://{HOST}:{10_000 + number % 50_000}/"
        call = xmlrpc("registerSubscriber", f"/invented{number}", "/tf", "tf2_msgs/TFMessage", uri)
        await say(port, call, seconds=1.0)
    return count


async def frames(port: int, count: int) -> int:
    """Send MAVLink heartbeats as fast as they go."""
    link = mav.MAVLink(None, srcSystem=250)
    beat = link.heartbeat_encode(6, 8, 0, 0, 0).pack(link)
    return 50 * await say(port, beat * 50, count // 50, 1, 10.0)


async def datagrams(port: int, count: int) -> int:
    """Send MAVLink heartbeats from as many addresses."""
    link = mav.MAVLink(None, srcSystem=251)
    beat = link.heartbeat_encode(6, 8, 0, 0, 0).pack(link)
    for _ in range(count):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
            client.sendto(beat, (HOST, port))
        await asyncio.sleep(0)
    return count


async def wrong_keys(port: int, count: int) -> int:
    """Try keys, each on a connection of its own."""
    return await say(port, b'{"key": "a"}\n', 1, count)


Attack: TypeAlias = tuple[str, Callable[[], Coroutine[None, None, int]]]


def attacks(doors: Doors, draws: random.Random, scale: int) -> list[Attack]:
    """All attacks, each with a name; `scale` 1 is quick, 10 as large as it was found."""
    forged = b'%%error SimR Game thbridge {"kind":"Status","game":1}\n'
    surrogate = b'%%error SimR Game thbridge {"kind":"GiveUp","game":"\\ud800"}\n'
    slow = b'%%found Hider TabUI 1 1 "(Colour: ' + b") (Footprint: " * 4600 + b"\n"
    ready = b'%%setid P extended\n%%error P Game thbridge {"kind":"ParticipantReady"}\n'
    names = b"".join(ready.replace(b"P ", f"P{number} ".encode()) for number in range(50))
    endless = b"x" * 2**20
    page = xmlrpc("getPid", "x").replace(b"\r\n", b"\r\nOrigin: http://a.example\r\n", 1)
    return [
        ("text: half a surrogate in a notice", lambda: say(doors.text, surrogate)),
        ("text: a line that regular expressions shun", lambda: say(doors.text, slow, 10)),
        ("text: notices in another's name", lambda: say(doors.text, forged, 500)),
        ("text: invented participants", lambda: say(doors.text, names, 10 * scale)),
        ("text: a line without end", lambda: say(doors.text, endless, 30 * scale)),
        ("text: short lines, one connection", lambda: say(doors.text, b"%%error A B x\n" * 500, 20 * scale)),
        ("text: short lines, 100 connections", lambda: say(doors.text, b"%%error A B x\n" * 500, 2 * scale, 100)),
        ("text: 300 silent connections", lambda: idle(doors.text, 300)),
        ("text: connections one after the other", lambda: turned_away(doors.text, 1000 * scale)),
        ("text: a page in a browser", lambda: say(doors.text, http("/", "\n%%goto TabUI SimR 0 3 3 45\n"), 1, 20)),
        ("text: noise", lambda: noise(doors.text, draws)),
        ("watch: 40 without a key", lambda: idle(doors.watch, 40)),
        ("watch: wrong keys", lambda: wrong_keys(doors.watch, 100 * scale)),
        ("watch: a line without end", lambda: say(doors.watch, endless, 30 * scale)),
        ("watch: noise", lambda: noise(doors.watch, draws)),
        ("ROS: invented subscribers", lambda: subscribers(doors.ros, 300 * scale)),
        ("ROS: a page in a browser", lambda: say(doors.ros, page, 1, 20)),
        ("ROS: 200 silent connections", lambda: idle(doors.ros, 200)),
        ("ROS: noise", lambda: noise(doors.ros, draws)),
        ("MAVLink: frames by TCP", lambda: frames(doors.tcp, 15_000 * scale)),
        ("MAVLink: datagrams of many addresses", lambda: datagrams(doors.udp, 500 * scale)),
        ("MAVLink: a page in a browser", lambda: say(doors.tcp, http("/", "x"), 1, 20)),
        ("MAVLink: noise", lambda: noise(doors.tcp, draws)),
    ]


def free_ports(count: int) -> list[int]:
    """Ports that nobody listens at."""
    sockets = [socket.create_server((HOST, 0)) for _ in range(count)]
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def memory_of(process: subprocess.Popen[bytes]) -> float:
    """Resident megabytes of a process."""
    pages = int(Path(f"/proc/{process.pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGESIZE") / 2**20


def descriptors_of(process: subprocess.Popen[bytes]) -> int:
    """Open files of a process."""
    return len(list(Path(f"/proc/{process.pid}/fd").iterdir()))


@dataclass(frozen=True, slots=True)
class Held:
    """Outcome of an attack.

    Attributes:
        attack: its name.
        tries: how often it did what it does.
        wait: longest wait of honest people, seconds.
        lag: by which the session fell behind, seconds.
        memory: megabytes that it cost.
        descriptors: open files of the session afterwards.
        running: False where it ended the session.
        refused: how often honest people were kept out.
    """

    attack: str
    tries: int
    wait: float
    lag: float
    memory: float
    descriptors: int
    running: bool
    refused: int

    @property
    def well(self) -> bool:
        """True where nobody else noticed much."""
        quick = max(self.wait, self.lag) <= WAIT_BOUND
        return self.running and not self.refused and quick and self.memory <= MEMORY_BOUND


def assault(doors: Doors, session: subprocess.Popen[bytes], seed: int, scale: int, only: str) -> list[Held]:
    """Let all attacks loose, one after the other."""
    honest, held = Honest(doors), []
    honest.start()
    for name, attack in attacks(doors, random.Random(seed), scale):
        if only not in name:
            continue
        before, lagged = memory_of(session), honest.lag
        honest.wait, honest.refused = 0.0, 0
        tries = asyncio.run(attack())
        time.sleep(1.5)
        running = session.poll() is None
        memory = memory_of(session) - before if running else 0.0
        descriptors = descriptors_of(session) if running else 0
        wait, lag, refused = honest.wait, honest.lag - lagged, honest.refused
        held.append(Held(name, tries, wait, lag, memory, descriptors, running, refused))
        print(row(held[-1]), flush=True)
        if not running:
            break
    honest.stop()
    return held


def row(held: Held) -> str:
    """Return a line of the table."""
    outcome = "held" if held.well else "ENDED" if not held.running else "GAVE WAY"
    return (
        f"{held.attack:<45} {held.tries:>7} {1000 * held.wait:>7.0f} ms {1000 * held.lag:>7.0f} ms {held.refused:>7} "
        f"{held.memory:>+7.0f} MB {held.descriptors:>5}  {outcome}"
    )


def main() -> int:
    """Run the attack."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="of the random bytes")
    parser.add_argument("--scale", type=int, default=1, help="1: a minute or two; 10: as large as attacks were found")
    parser.add_argument("--only", default="", help="attacks with this in their name")
    given = parser.parse_args()
    doors = Doors(*free_ports(5))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        key = folder / "key.txt"
        key.write_text(KEY)
        key.chmod(0o600)
        command = [sys.executable, "-c", "from ui.cli import main; main()", "play", "--outside", "TabUI"]
        options = ["--port", str(doors.text), "--watch", str(doors.watch), "--watch-key", str(key), "--ros"]
        options += ["--ros-master", f"http://{HOST}:{doors.ros}", "--mavlink", "--tcp", f"{HOST}:{doors.tcp}"]
        options += ["--udp-listen", f"{HOST}:{doors.udp}", "--rate", "1", "--bag", "hunt.bag", "--no-report"]
        told = folder / "told.txt"
        with told.open("wb") as file:
            session = subprocess.Popen(
                [*command, *options],
                cwd=folder,
                stdout=file,
                stderr=file,
                env={**os.environ, "PYTHONPATH": str(Path.cwd())},
            )
        try:
            while "join at" not in told.read_text():
                if session.poll() is not None:
                    print(told.read_text())
                    return 1
                time.sleep(0.1)
            titles = f"{'wait':>10} {'lag':>10} {'refused':>7} {'memory':>10} {'files':>5}"
            print(f"{'attack':<45} {'tries':>7} {titles}  outcome")
            held = assault(doors, session, given.seed, given.scale, given.only)
        finally:
            if session.poll() is None:
                session.send_signal(signal.SIGTERM)
            session.wait(60)
        text = told.read_text()
        recorded = (folder / "hunt.bag").exists()
    traceback = "Traceback" in text
    print(f"The recording is {'whole' if recorded else 'NOT whole'}; {'a TRACEBACK' if traceback else 'no traceback'}.")
    if traceback:
        print(text[text.index("Traceback") - 500 :][:3000])
    print(json.dumps({"attacks": len(held), "held": sum(each.well for each in held)}))
    return 0 if all(each.well for each in held) and recorded and not traceback else 1


if __name__ == "__main__":
    sys.exit(main())
