"""Attack all ports of a session on this machine, on the loopback only and with limits, and report the reaction.

Run this script from the project's folder: `.venv/bin/python scripts/attack.py` (`make attack`). It starts a hunt with
all ports open, and runs one attack after the other. During the attacks, it measures the waiting times of honest
programs, the memory and descriptors of the session, and whether the session still runs. Attacks with many connections
or endless lines come from separate processes, which have all the descriptors that the system allows. The exit code is 1
if an attack succeeded.
"""

import argparse
import asyncio
import contextlib
import hashlib
import json
import multiprocessing
import os
import pickle
import random
import resource
import selectors
import signal
import socket
import sqlite3
import ssl
import struct
import subprocess
import sys
import tempfile
import threading
import time
import xmlrpc.client
from collections.abc import Callable, Coroutine, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import IO, TypeAlias, cast

import attack_browsers
import attack_ros2
import attack_zenoh
from attack_browsers import BrowserBreachError, PlayingPerson
from free_ports import free_ports

from sim.numerics.compiled_files import write
from thbridge.credentials import Right, key_line
from thbridge.experiment.store.event_log import ExperimentLog
from thbridge.experiment.store.head import LogHead, head_path
from thbridge.files.keys.key_ring import KeyRing
from thbridge.mavlink.wire.dialect import mav
from thbridge.roles.shared.participant_lines import encode_request_line
from thbridge.roles.shared.view import RequestSuggestion
from thbridge.ros2graph.sockets.dds import DdsCarrier
from thbridge.ros2graph.sockets.zenoh import ZenohCarrier
from thbridge.sockets.addresses import Address
from thbridge.text_protocol.wire.lines import encode_line
from thbridge.timing.wall_clock import utc_now
from thbridge.watching.wire import BagStreamReader, SessionMessage, parse_status

HOST = "127.0.0.1"
PATIENCE = 10.0
WAIT_BOUND = 1.0
"""Maximum wait of honest programs, and maximum lag of the session, for a successful test, seconds."""
MEMORY_BOUND = 256
"""Maximum increase of memory during one attack, megabytes."""
_OUTSIDE = 8
"""Number of attacking processes."""
KEY = "honest-" + "0123456789abcdef"


@dataclass(frozen=True, slots=True)
class Doors:
    """Ports of the session."""

    text: int
    watch: int
    tcp: int
    udp: int
    ros: int
    foxglove: int
    web: int
    ros2: int = 0
    """Domain of the ROS 2 graph."""
    router: int = 0
    """Port of the zenoh router. If 0, the ROS 2 graph uses DDS."""
    node: int = 0
    tcpros: int = 0

    def with_node(self) -> "Doors":
        """Return these ports and the ports of the session's ROS node, as reported by the master and the node."""
        master = xmlrpc.client.ServerProxy(f"http://{HOST}:{self.ros}/")
        published: dict[str, list[str]] = {}
        while not any("/scan" in topic for topic in published):
            _, _, state = cast("tuple[int, str, list[list[tuple[str, list[str]]]]]", master.getSystemState("/attack"))
            published = dict(state[0])
            time.sleep(0.1)
        topic, nodes = next((topic, nodes) for topic, nodes in published.items() if "/scan" in topic)
        _, _, uri = cast("tuple[int, str, str]", master.lookupNode("/attack", nodes[0]))
        asked = xmlrpc.client.ServerProxy(uri).requestTopic("/attack", topic, [["TCPROS"]])
        return replace(self, node=int(uri.rstrip("/").rpartition(":")[2]), tcpros=cast("list[list[int]]", asked)[2][2])


class Honest(threading.Thread):
    """Thread that runs honest programs during an attack; some of them open a new connection for each request.

    They are a participant's program, a client with a key, a researcher, a ground station, ROS tools at the master and a
    node, a node of ROS 2, and a person who plays a game in a browser.

    Attributes:
        wait: longest waiting time of a program since `wait` was last reset, seconds.
        slowest: program that waited longest.
        lag: time by which the session is behind its pace, seconds, including time that cannot be made up.
        refused: number of connections that were closed or refused.
    """

    def __init__(self, doors: "Doors") -> None:
        super().__init__(daemon=True)
        self._person = PlayingPerson(doors.web)
        self._node = attack_ros2.HonestNode(
            ZenohCarrier(doors.ros2, Address(HOST, doors.router)) if doors.router else DdsCarrier(doors.ros2)
        )
        self.wait = self.lag = 0.0
        self.refused = 0
        self.slowest = ""
        self._doors = doors
        self._stopped = threading.Event()
        self._rounds = threading.Semaphore(0)
        self._client: socket.socket | None = None
        self._station: socket.socket | None = None

    def run(self) -> None:
        """Send a request to all ports ten times per second, until `stop` is called."""
        people: dict[str, Callable[[], None]] = {
            "text": self._ping,
            "a key": self._show_key,
            "watch": self._watch,
            "MAVLink": self._beat,
            "master": lambda: self._call(self._doors.ros),
            "node": lambda: self._call(self._doors.node),
            "ROS 2": self._node.go_on,
            "browser": self._person.go_on,
        }
        while not self._stopped.wait(0.1):
            for name, ask in people.items():
                began = time.monotonic()
                try:
                    ask()
                except OSError:
                    self.refused += 1
                    self._client, self._station = (None if name == "text" else self._client), None
                waited = time.monotonic() - began
                if waited > self.wait:
                    self.wait, self.slowest = waited, name
            self._rounds.release()

    def finish(self) -> None:
        """Wait until all programs have got an answer to a request that they have sent since this call."""
        while self._rounds.acquire(blocking=False):
            pass
        for _ in range(2):  # The first round has begun earlier.
            self._rounds.acquire()

    def stop(self) -> None:
        """Stop the requests."""
        self._stopped.set()
        self.join(30)
        self._node.close()

    def _ping(self) -> None:
        if self._client is None:
            self._client = socket.create_connection((HOST, self._doors.text), PATIENCE)
            self._client.sendall(b"%%setid Honest\n")
        self._client.sendall(b"%%ping\n")
        heard = b""
        while b"%%pong" not in heard:
            heard += received(self._client)

    def _show_key(self) -> None:
        client = socket.create_connection((HOST, self._doors.text), PATIENCE)
        with client, unchecked_tls().wrap_socket(client) as encrypted:
            encrypted.sendall(key_line(KEY))
            if b"admitted" not in received(encrypted):
                raise ConnectionError

    def _beat(self) -> None:
        link = mav.MAVLink(None, srcSystem=249)
        if self._station is None:
            self._station = socket.create_connection((HOST, self._doors.tcp), PATIENCE)
        self._station.sendall(link.ping_encode(7, 1, 0, 0).pack(link))
        parser = mav.MAVLink(None)
        parser.robust_parsing = True
        while not any(each.get_type() == "PING" for each in parser.parse_buffer(received(self._station)) or ()):
            pass

    def _call(self, port: int) -> None:
        with socket.create_connection((HOST, port), PATIENCE) as client:
            client.sendall(xmlrpc_call("getPid", "/honest"))
            if b" 200 " not in received(client):
                raise ConnectionError

    def _watch(self) -> None:
        stream = BagStreamReader()
        plain = socket.create_connection((HOST, self._doors.watch), PATIENCE)
        with plain, unchecked_tls().wrap_socket(plain) as client:
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
    """Wait for bytes. Raise OSError if the connection is closed."""
    data = client.recv(2**18)
    if not data:
        raise ConnectionError
    return data


async def connections(port: int, count: int) -> list[asyncio.StreamWriter]:
    """Open up to `count` connections; ignore refused connections."""
    writers = []
    for _ in range(count):
        with contextlib.suppress(OSError):
            writers.append((await asyncio.open_connection(HOST, port))[1])
    return writers


def unchecked_tls() -> ssl.SSLContext:
    """Return a TLS context that trusts any server, because the attack stays on this machine."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    return context


async def say(
    port: int, data: bytes, times: int = 1, count: int = 1, seconds: float = 5.0, *, encrypted: bool = False
) -> int:
    """Send the same data repeatedly on some connections, until all data are sent or the time is over.

    Returns:
        How often the data were sent.
    """
    said, tls = 0, unchecked_tls() if encrypted else None

    async def one() -> None:
        nonlocal said
        with contextlib.suppress(OSError, asyncio.CancelledError):
            _, writer = await asyncio.open_connection(HOST, port, ssl=tls)
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
    """Keep connections open for 2.5 s without sending anything."""
    writers = await connections(port, count)
    await asyncio.sleep(2.5)
    for writer in writers:
        writer.close()
    return count


async def turned_away(port: int, count: int) -> int:
    """Open connections one after the other without waiting for them; at most 400 are open at the same time."""
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
    """Send random bytes on some connections."""
    return await say(port, draws.randbytes(8192), 20, 20)


def prepare_outside() -> None:
    """Allow this process all descriptors that the system allows, and give it the lowest priority.

    The low priority leaves processor time for the session, whose reaction is measured.
    """
    os.setpriority(os.PRIO_PROCESS, 0, 19)
    _, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (hard, hard))


def crowd(port: int, count: int, seconds: float) -> tuple[int, int]:
    """Open many connections and send nothing; return the numbers of opened and of closed connections."""
    made, cut = 0, 0
    with selectors.DefaultSelector() as selector:
        clients = []
        for _ in range(count):
            try:
                client = socket.socket()
            except OSError:
                break
            client.setblocking(False)
            with contextlib.suppress(BlockingIOError, OSError):
                client.connect((HOST, port))
            clients.append(client)
            selector.register(client, selectors.EVENT_WRITE)
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for key, _ in selector.select(0.2):
                client = cast(socket.socket, key.fileobj)
                if key.events & selectors.EVENT_WRITE and not client.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
                    made += 1
                    selector.modify(client, selectors.EVENT_READ)
                    continue
                try:
                    ended = not client.recv(2**16)
                except BlockingIOError:
                    continue
                except OSError:
                    ended = True
                if ended:
                    cut += 1
                    selector.unregister(client)
        for client in clients:
            client.close()
    return made, cut


def pour(port: int, begin: bytes, piece: bytes, times: int, seconds: float) -> tuple[int, int]:
    """Send endless data on a connection; return the number of accepted pieces, and 1 if the connection was closed."""
    said = 0
    try:
        with socket.create_connection((HOST, port), PATIENCE) as client:
            end = time.monotonic() + seconds
            client.sendall(begin)
            while said < times and time.monotonic() < end:
                client.settimeout(max(0.1, end - time.monotonic()))
                client.sendall(piece)
                said += 1
    except TimeoutError:
        return said, 0
    except OSError:
        return said, 1
    return said, 0


def shower(port: int, piece: bytes, times: int) -> tuple[int, int]:
    """Send datagrams; return their number, and 0."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        for _ in range(times):
            with contextlib.suppress(OSError):
                client.sendto(piece, (HOST, port))
    return times, 0


class Outside:
    """Attackers in separate processes.

    Attributes:
        cut: number of connections that the session closed in the last attack.
    """

    def __init__(self) -> None:
        self._pool = ProcessPoolExecutor(_OUTSIDE, multiprocessing.get_context("spawn"), prepare_outside)
        # The processes start before the measurement, because their start uses the session's processor.
        list(self._pool.map(time.sleep, [2.0] * _OUTSIDE))
        self.cut = 0

    async def __call__(self, *attacks: Callable[[], tuple[int, int]]) -> int:
        """Run attackers at the same time; return the total number of their attempts."""
        loop = asyncio.get_running_loop()
        outcomes = await asyncio.gather(*(loop.run_in_executor(self._pool, attack) for attack in attacks))
        self.cut = sum(cut for _, cut in outcomes)
        return sum(said for said, _ in outcomes)


def http(path: str, body: str, headers: str = "") -> bytes:
    """Return an HTTP request as a web page in a browser would send it."""
    return f"POST {path} HTTP/1.1\r\nHost: {HOST}\r\n{headers}Content-Length: {len(body)}\r\n\r\n{body}".encode()


def xmlrpc_call(method: str, *arguments: str) -> bytes:
    """Return a request that calls a method of the ROS master."""
    values = "".join(f"<param><value><string>{argument}</string></value></param>" for argument in arguments)
    body = f"<?xml version='1.0'?><methodCall><methodName>{method}</methodName><params>{values}</params></methodCall>"
    return http("/RPC2", body, "Content-Type: text/xml\r\n")


async def subscribers(port: int, count: int) -> int:
    """Register fake subscribers of the topic /tf at the ROS master."""
    for number in range(count):
        uri = f"http://{HOST}:{10_000 + number % 50_000}/"
        call = xmlrpc_call("registerSubscriber", f"/invented{number}", "/tf", "tf2_msgs/TFMessage", uri)
        await say(port, call, seconds=1.0)
    return count


async def frames(port: int, count: int) -> int:
    """Send MAVLink heartbeats as fast as possible over TCP."""
    link = mav.MAVLink(None, srcSystem=250)
    beat = link.heartbeat_encode(6, 8, 0, 0, 0).pack(link)
    return 50 * await say(port, beat * 50, count // 50, 1, 10.0)


async def datagrams(port: int, count: int) -> int:
    """Send MAVLink heartbeats, each from another port."""
    link = mav.MAVLink(None, srcSystem=251)
    beat = link.heartbeat_encode(6, 8, 0, 0, 0).pack(link)
    for _ in range(count):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
            client.sendto(beat, (HOST, port))
        await asyncio.sleep(0)
    return count


class BreachError(Exception):
    """An attack achieved something that must be impossible."""


class _Planted:
    """Pickle that creates a file when it is loaded."""

    def __init__(self, mark: Path) -> None:
        self._mark = mark

    def __reduce__(self) -> tuple[object, ...]:
        return Path.touch, (self._mark,)


async def planted_code() -> int:
    """Plant pickles in a program's cache of compiled code.

    In each round, another level of the cache's folders is writable for other accounts.

    Raises:
        BreachError: the program loaded a planted pickle.
    """
    program = "import numpy; from sim.numerics.elementary_kernels import to_hypot; to_hypot(*numpy.ones((2, 1)))"
    tries = 0
    for level in range(4):
        with tempfile.TemporaryDirectory() as name:
            cache, mark = Path(name, "cache"), Path(name, "mark")
            environment = {**os.environ, "PYTHONPATH": str(Path.cwd()), "NUMBA_CACHE_DIR": str(cache)}
            start = partial(
                asyncio.create_subprocess_exec,
                sys.executable, "-c", program, env=environment, umask=0, stderr=asyncio.subprocess.DEVNULL,
            )  # fmt: skip
            await (await start()).wait()
            for file in cache.glob("kernels/*/*"):
                write(file, pickle.dumps(_Planted(mark)))
                [file, *file.parents][level].chmod(0o777)
                tries += 1
            await (await start()).wait()
            if mark.exists():
                raise BreachError
    return tries


COMMAND = [sys.executable, "-c", "from ui.cli import main; main()"]
OTHER = 54321
"""User id of another account."""


async def ended(*arguments: object) -> int:
    """Run a command of thbridge to its end; return its exit code."""
    environment = {**os.environ, "PYTHONPATH": str(Path.cwd())}
    quiet = asyncio.subprocess.DEVNULL
    process = await asyncio.create_subprocess_exec(
        "nice", "-n", "19", *COMMAND, *map(str, arguments), env=environment, stdin=quiet, stdout=quiet, stderr=quiet
    )
    try:
        return await process.wait()
    finally:
        if process.returncode is None:
            process.kill()


def contents(folder: Path) -> dict[Path, bytes]:
    """Return all files below a folder."""
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


async def names_that_lead_elsewhere() -> int:
    """Run commands with names that are paths outside the folders in which the commands delete and write.

    Raises:
        BreachError: a file was deleted or changed, or a command accepted such a name.
    """
    with tempfile.TemporaryDirectory() as name:
        mine, study = Path(name, "mine"), Path(name, "study")
        mine.mkdir()
        (mine / "file").write_text("mine")
        await ended("study", "new", Path(name, "plan"))
        await ended("study", "rehearse", Path(name, "plan"), "--to", study, "--no-games")
        (study / "recordings" / "P-MINE").mkdir(parents=True)
        (study / "recordings" / "P-MINE" / "step-1.bag").write_text("a game")
        before = contents(Path(name))
        names = ["..", ".", "", " ", str(mine), "../../mine", "recordings/P-MINE", "P-MINE/../../../mine"]
        codes = [await ended("study", "withdraw", study, each, "--yes") for each in names]
        codes += [await ended("keys", "new", each, "--right", "watch", "--keys", study) for each in names]
        if 0 in codes or contents(Path(name)) != before:
            raise BreachError
    return 2 * len(names)


ENDLESS_VIEW = """CREATE VIEW events AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n)
SELECT i AS sequence, NULL AS salt, NULL AS content, NULL AS digest, NULL AS chain FROM n"""
ODD_EVENTS = ["[" * 100_000, '{"kind": 5}', '{"kind": "note", "data": []}', '"zebra"']
ODD_SWEEPS = ["[]", "[" * 100_000, '{"layout": 1}', '{"layout": 1, "design": {"levels": []}, "versions": {}}']


def write_odd_log(log: Path, content: str | None) -> None:
    """Write one event into a new log, with correct digests, chain and head.

    If `content` is None, replace the table of events by a view with endless rows.
    """
    for path in (log, head_path(log)):
        path.unlink(missing_ok=True)
    with ExperimentLog(log):
        pass
    with contextlib.closing(sqlite3.connect(log)) as database:
        if content is None:
            database.execute("DROP TABLE events")
            database.execute(ENDLESS_VIEW)
        else:
            digest = hashlib.sha256(bytes(16) + content.encode()).digest()
            chain = hashlib.sha256(hashlib.sha256(b"thbridge experiment log 1").digest() + digest).digest()
            database.execute("INSERT INTO events VALUES (1, ?, ?, ?, ?)", (bytes(16), content, digest, chain))
            LogHead(1, chain).write(log)
        database.commit()


async def odd_files(place: Path) -> int:
    """Run commands on logs and on sweeps that have correct digests but invalid contents.

    Raises:
        BreachError: a command did not refuse a file with a message, or did not end.
    """
    study, sweep = place / "study", place / "sweep"
    sweep.mkdir(parents=True)
    await ended("study", "new", study)
    (study / "store").mkdir()
    codes = []
    with contextlib.suppress(TimeoutError):
        async with asyncio.timeout(20 * PATIENCE):
            for content in (*ODD_EVENTS, None):
                write_odd_log(study / "store" / "log", content)
                codes.append(await ended("study", "status", study))
            for content in ODD_SWEEPS:
                (sweep / "sweep.json").write_text(content)
                codes.append(await ended("sweep", "status", sweep))
    if codes != [2] * (len(ODD_EVENTS) + 1 + len(ODD_SWEEPS)):
        raise BreachError
    return len(codes)


async def links_of_others() -> int:
    """Create links that belong to another account, at the paths that commands write.

    Raises:
        BreachError: a command followed a link.
    """
    with tempfile.TemporaryDirectory() as name:
        mine, place = Path(name, "mine"), Path(name, "place")
        for folder in (mine, place):
            folder.mkdir()
        (mine / "file").write_text("mine")
        for link, target in (("folder", mine), ("file", mine / "new")):
            (place / link).symlink_to(target)
            os.lchown(place / link, OTHER, OTHER)
        before = contents(mine)
        codes = [
            await ended("study", "new", place / "folder" / "study"),
            await ended("keys", "new", "cleo", "--right", "watch", "--keys", place / "folder" / "keys"),
            await ended("study", "init", place / "file"),
            await ended("play", "--headless", "--max-seconds", 1, "--bag", place / "folder" / "hunt.bag"),
        ]
        if 0 in codes or contents(mine) != before:
            raise BreachError
    return len(codes)


async def links_in_a_recording(folder: Path) -> int:
    """Create links at the paths of the next parts of a recording; a new part begins every two seconds.

    Raises:
        BreachError: the session wrote to a link's target.
    """
    mine = folder / "mine"
    mine.write_text("mine")
    begun = len([*folder.glob("hunt_*.bag*")])
    links = [folder / f"hunt_{number}.bag.active.new" for number in range(begun + 1, begun + 4)]
    last = folder / f"hunt_{begun + 3}.bag"
    for link in links:
        link.symlink_to(mine)
    for _ in range(300):
        if last.exists():
            break
        await asyncio.sleep(0.05)
    if mine.read_text() != "mine" or not last.exists():
        raise BreachError
    return len(links)


LEFT = b"\x16\x03\x01\x02\x00\x01"
"""Beginning of a TLS handshake."""

Attack: TypeAlias = tuple[str, Callable[[], Coroutine[None, None, int]]]


def crowds_and_floods(doors: Doors, outside: Outside, scale: int) -> Iterator[Attack]:
    """Yield attacks on each port with many connections and endless data (at scale 10: 10,000 connections, 300 MB)."""
    ports = {
        "text": doors.text,
        "watch": doors.watch,
        "MAVLink": doors.tcp,
        "ROS master": doors.ros,
        "ROS node": doors.node,
        "TCPROS": doors.tcpros,
        "Foxglove": doors.foxglove,
    }
    count, megabytes, patience = 1000 * scale, 30 * scale, 30.0 * scale
    for door, port in ports.items():
        yield f"{door}: many connections at once", partial(outside, partial(crowd, port, count, 6.0))
    all_at_once = [partial(crowd, port, count, 10.0) for port in ports.values()]
    yield "all ports: many connections at once", partial(outside, *all_at_once)
    line = b"x" * 2**20
    claim = struct.pack("<I", megabytes * 2**20)
    head = f"POST /RPC2 HTTP/1.1\r\nHost: {HOST}\r\n".encode()
    announced = b"Content-Type: text/xml\r\nContent-Length: %d\r\n\r\n" % (megabytes * 2**20)
    chunked = head + b"Transfer-Encoding: chunked\r\n\r\n"
    chunk = b"100000\r\n" + line + b"\r\n"
    upgrade = f"GET / HTTP/1.1\r\nHost: {HOST}\r\nX-Long: ".encode()
    service = b"".join(
        struct.pack("<I", len(field)) + field
        for field in (b"callerid=/attack", b"md5sum=*", b"persistent=1", b"service=/static_map")
    )
    request = struct.pack("<I", len(service)) + service + claim
    poured: list[tuple[str, int, bytes, bytes]] = [
        ("text: megabytes without a newline", doors.text, b"", line),
        ("watch: megabytes without a newline", doors.watch, b"", line),
        ("watch: megabytes after the key", doors.watch, key_line(KEY), line),
        ("MAVLink: megabytes by TCP", doors.tcp, b"", line),
        ("MAVLink: megabytes of frame headers", doors.tcp, b"", b"\xfd\xff" * 2**19),
        ("TCPROS: a length of megabytes, and the data", doors.tcpros, claim, line),
        ("TCPROS: a request of megabytes", doors.tcpros, request, line),
        ("Foxglove: megabytes of header", doors.foxglove, upgrade, line),
    ]
    for name, port in (("master", doors.ros), ("node", doors.node)):
        poured += [
            (f"ROS {name}: megabytes of header", port, head + b"X-Long: ", line),
            (f"ROS {name}: megabytes of headers", port, head, b"X-Short: x\r\n" * 2**16),
            (f"ROS {name}: megabytes of body", port, head + announced, line),
            (f"ROS {name}: megabytes in chunks", port, chunked, chunk),
            (f"ROS {name}: megabytes of a chunk's length", port, chunked, b"0" * 2**20),
        ]
    for name, port, begin, piece in poured:
        yield name, partial(outside, partial(pour, port, begin, piece, megabytes, patience))
    yield "MAVLink: megabytes by UDP", partial(outside, partial(shower, doors.udp, b"\xfd" * 60_000, 17 * megabytes))


def attacks_on_browsers(doors: Doors, outside: Outside, draws: random.Random, scale: int) -> Iterator[Attack]:
    """Yield attacks on the port for browsers."""
    port, line = doors.web, b"x" * 2**20
    head = f"GET / HTTP/1.1\r\nHost: {HOST}:{port}\r\n".encode()
    post = head.replace(b"GET", b"POST")
    long = 100 * 2**20
    deflate = "Sec-WebSocket-Extensions: permessage-deflate; client_max_window_bits\r\n"
    empty = attack_browsers.frame(b"{", 1) + 1000 * attack_browsers.frame(b"", 0)
    wrong = attack_browsers.wrong_messages(draws)
    yield "web: forged origins", lambda: attack_browsers.forged_origins(port, 20 * scale)
    yield "web: guessed cookies", lambda: attack_browsers.guessed_cookies(port, 20 * scale)
    yield "web: guessed keys of the researcher", lambda: attack_browsers.guessed_keys(port, 20 * scale)
    yield "web: visitors who never connect", lambda: attack_browsers.many_visitors(port, 100 * scale)
    yield "web: many sockets with one secret", lambda: attack_browsers.one_secret(port, 20 * scale)
    yield "web: malformed and nested messages", lambda: attack_browsers.said_on_sockets(port, wrong, 20 * scale)
    yield "web: scripts in texts", lambda: attack_browsers.scripts_in_texts(port)
    frames: dict[str, tuple[bytes, int, str]] = {
        "web: a frame of 100 MB": (attack_browsers.frame(line, 0x81, long), 100, ""),
        "web: frames of 60 kB": (attack_browsers.frame(b"x" * 60_000, 0x81), 1000 * scale, ""),
        "web: tiny frames": (1000 * attack_browsers.frame(b"{}", 0x81), 100 * scale, ""),
        "web: empty pieces of one message": (empty, 100, ""),
        "web: compressed bombs": (attack_browsers.bomb(), 10 * scale, deflate),
    }
    for name, (data, times, extensions) in frames.items():
        yield name, partial(attack_browsers.raw_frames, port, data, times, extensions)
    yield "web: slow headers", lambda: attack_browsers.slowly(port, head, b"X-A: a\r\n", 200 * scale, 12.0)
    body = post + b"Content-Length: 99999999\r\n\r\n"
    yield "web: slow bodies", lambda: attack_browsers.slowly(port, body, b"x", 200 * scale, 5.0)
    yield "web: successive connections", lambda: turned_away(port, 1000 * scale)
    yield "web: noise", lambda: noise(port, draws)
    yield "web: many connections at once", partial(outside, partial(crowd, port, 1000 * scale, 6.0))
    for name, begin, piece in (
        ("header", head + b"X-Long: ", line),
        ("headers", head, b"X-Short: x\r\n" * 2**16),
        ("body", body, line),
        ("chunks", post + b"Transfer-Encoding: chunked\r\n\r\n", b"100000\r\n" + line + b"\r\n"),
    ):
        yield f"web: megabytes of {name}", partial(outside, partial(pour, port, begin, piece, 30 * scale, 30.0))


def attacks_on_ros2(doors: Doors, outside: Outside, scale: int) -> Iterator[Attack]:
    """Yield attacks on the ROS 2 graph."""

    async def run(*attacks: Callable[[], tuple[int, int]]) -> int:
        tries = await outside(*attacks)
        if outside.cut:
            raise BreachError
        return tries

    if doors.router:
        for name, attacks in attack_zenoh.attacks_on_zenoh(doors.ros2, doors.router, scale):
            yield name, partial(run, *attacks)
        return
    for name, attack in attack_ros2.attacks_on_ros2(doors.ros2, scale):
        yield name, partial(run, attack)


def attacks(doors: Doors, outside: Outside, draws: random.Random, scale: int, folder: Path) -> list[Attack]:
    """Return all attacks with their names. Scale 1 is quick, 10 is the original size; the session runs in `folder`."""
    if doors.router:  # All other ports were attacked while the session used DDS.
        return [*attacks_on_ros2(doors, outside, scale)]
    may_give_away = os.geteuid() == 0
    forged = b'%%error SimR Game thbridge {"kind":"Status","game":1}\n'
    surrogate = b'%%error SimR Game thbridge {"kind":"GiveUp","game":"\\ud800"}\n'
    slow = b'%%found Hider TabUI 1 1 "(Footprint: ' + b") (Footprint: " * 4600 + b"\n"
    ready = b'%%setid P extended\n%%error P Game thbridge {"kind":"ParticipantReady"}\n'
    advice = encode_line(encode_request_line(RequestSuggestion(0), 7).line())
    names = b"".join(ready.replace(b"P ", f"P{number} ".encode()) for number in range(50))
    endless = b"x" * 2**20
    page = xmlrpc_call("getPid", "x").replace(b"\r\n", b"\r\nOrigin: http://a.example\r\n", 1)
    return [
        ("text: half a surrogate in a notice", lambda: say(doors.text, surrogate)),
        ("text: a line that is slow for regular expressions", lambda: say(doors.text, slow, 10)),
        ("text: notices with a forged name", lambda: say(doors.text, forged, 500)),
        ("text: fake participants", lambda: say(doors.text, names, 10 * scale)),
        ("text: the same request for advice", lambda: say(doors.text, b"%%setid TabUI\n" + advice * 500, 20 * scale)),
        ("text: a line without end", lambda: say(doors.text, endless, 30 * scale)),
        ("text: short lines, one connection", lambda: say(doors.text, b"%%error A B x\n" * 500, 20 * scale)),
        ("text: short lines, 100 connections", lambda: say(doors.text, b"%%error A B x\n" * 500, 2 * scale, 100)),
        ("text: 300 silent connections", lambda: idle(doors.text, 300)),
        ("text: successive connections", lambda: turned_away(doors.text, 1000 * scale)),
        ("text: a page in a browser", lambda: say(doors.text, http("/", "\n%%goto TabUI SimR 0 3 3 45\n"), 1, 20)),
        ("text: wrong keys", lambda: say(doors.text, key_line("a"), 1, 100 * scale, encrypted=True)),
        ("text: abandoned handshakes", lambda: say(doors.text, LEFT, 1, 1000 * scale)),
        ("text: a key without end", lambda: say(doors.text, endless, 30 * scale, encrypted=True)),
        ("text: noise", lambda: noise(doors.text, draws)),
        ("watch: 40 without a key", lambda: idle(doors.watch, 40)),
        ("watch: wrong keys", lambda: say(doors.watch, key_line("a"), 1, 100 * scale)),
        ("watch: wrong keys, encrypted", lambda: say(doors.watch, key_line("a"), 1, 100 * scale, encrypted=True)),
        ("watch: abandoned handshakes", lambda: say(doors.watch, LEFT, 1, 1000 * scale)),
        ("watch: a key without end", lambda: say(doors.watch, endless, 30 * scale, encrypted=True)),
        ("watch: a line without end", lambda: say(doors.watch, endless, 30 * scale)),
        ("watch: noise", lambda: noise(doors.watch, draws)),
        ("ROS: fake subscribers", lambda: subscribers(doors.ros, 300 * scale)),
        ("ROS: a page in a browser", lambda: say(doors.ros, page, 1, 20)),
        ("ROS: 200 silent connections", lambda: idle(doors.ros, 200)),
        ("ROS: noise", lambda: noise(doors.ros, draws)),
        ("MAVLink: frames by TCP", lambda: frames(doors.tcp, 15_000 * scale)),
        ("MAVLink: datagrams from many addresses", lambda: datagrams(doors.udp, 500 * scale)),
        ("MAVLink: a page in a browser", lambda: say(doors.tcp, http("/", "x"), 1, 20)),
        ("MAVLink: noise", lambda: noise(doors.tcp, draws)),
        ("cache: planted compiled code", planted_code),
        ("files: names outside the folder", names_that_lead_elsewhere),
        ("files: invalid logs and sweeps", lambda: odd_files(folder / "odd")),
        ("files: links at the path of a recording", lambda: links_in_a_recording(folder)),
        *([("files: links of another account", links_of_others)] if may_give_away else []),
        *crowds_and_floods(doors, outside, scale),
        *attacks_on_ros2(doors, outside, scale),
        *attacks_on_browsers(doors, outside, draws, scale),
    ]


class Gauge(threading.Thread):
    """Resources that a process uses, sampled repeatedly.

    Attributes:
        memory: greatest resident memory since `memory` was last reset, megabytes.
        descriptors: greatest number of open files since `descriptors` was last reset.
    """

    def __init__(self, pid: int) -> None:
        super().__init__(daemon=True)
        self.memory = 0.0
        self.descriptors = 0
        self._pid = pid

    def run(self) -> None:
        """Take twenty samples per second while the process runs."""
        with contextlib.suppress(OSError):
            while True:
                self.look()
                time.sleep(0.05)

    def look(self) -> float:
        """Take one sample; return the current memory. Raise OSError if the process has ended."""
        pages = int(Path(f"/proc/{self._pid}/statm").read_text().split()[1])
        now = pages * os.sysconf("SC_PAGESIZE") / 2**20
        self.memory = max(self.memory, now)
        self.descriptors = max(self.descriptors, sum(1 for _ in Path(f"/proc/{self._pid}/fd").iterdir()))
        return now


@dataclass(frozen=True, slots=True)
class Held:
    """Outcome of an attack.

    Attributes:
        attack: name of the attack.
        tries: number of attempts.
        wait: longest wait of honest programs, seconds.
        lag: time by which the session fell behind its pace, seconds.
        slowest: honest program that waited longest.
        memory: greatest increase of memory during the attack, megabytes.
        descriptors: greatest number of open files of the session during the attack.
        cut: number of closed connections of attackers in other processes.
        running: False if the attack ended the session.
        refused: number of times that honest programs were refused.
        breached: True if the attack achieved something that must be impossible.
    """

    attack: str
    tries: int
    wait: float
    slowest: str
    lag: float
    memory: float
    descriptors: int
    cut: int
    running: bool
    refused: int
    breached: bool

    @property
    def well(self) -> bool:
        """True if the attack failed: the session still runs within all bounds, and has refused no honest program."""
        quick = max(self.wait, self.lag) <= WAIT_BOUND
        return self.running and not self.refused and not self.breached and quick and self.memory <= MEMORY_BOUND


def assault(
    doors: Doors,
    session: subprocess.Popen[bytes],
    gateway: subprocess.Popen[bytes],
    seed: int,
    scale: int,
    only: str,
    folder: Path,
) -> list[Held]:
    """Run all attacks, one after the other, on a session that runs in a folder, and on a gateway for browsers."""
    honest, outside, held = Honest(doors), Outside(), []
    server = attack_browsers.server_of(gateway)
    gauges = {session: Gauge(session.pid), gateway: Gauge(server)}
    honest.start()
    for each in gauges.values():
        each.start()
    for name, attack in attacks(doors, outside, random.Random(seed), scale, folder):
        if only not in name:
            continue
        time.sleep(1.0)
        attacked = gateway if name.startswith("web:") else session
        gauge = gauges[attacked]
        before, lagged = gauge.look(), honest.lag
        honest.wait, honest.refused, honest.slowest = 0.0, 0, ""
        gauge.memory, gauge.descriptors, outside.cut = before, 0, 0
        tries, breached = 0, False
        try:
            tries = asyncio.run(attack())
        except (BreachError, BrowserBreachError):
            breached = True
        time.sleep(1.5)
        honest.finish()
        running = attacked.poll() is None and server == attack_browsers.server_of(gateway)
        held.append(
            Held(
                attack=name,
                tries=tries,
                wait=honest.wait,
                slowest=honest.slowest,
                lag=honest.lag - lagged,
                memory=gauge.memory - before,
                descriptors=gauge.descriptors,
                cut=outside.cut,
                running=running,
                refused=honest.refused,
                breached=breached,
            )
        )
        print(row(held[-1]), flush=True)
        if not running:
            break
    honest.stop()
    return held


def row(held: Held) -> str:
    """Return a line of the table."""
    outcome = "attack failed" if held.well else "SESSION ENDED" if not held.running else "ATTACK SUCCEEDED"
    return (
        f"{held.attack:<45} {held.tries:>7} {1000 * held.wait:>7.0f} ms {held.slowest:<8} {1000 * held.lag:>6.0f} ms "
        f"{held.refused:>7} {held.cut:>6} {held.memory:>+7.0f} MB {held.descriptors:>5}  {outcome}"
    )


def main() -> int:
    """Run the attacks, first with the ROS 2 graph over DDS, then over zenoh."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1, help="random seed")
    parser.add_argument(
        "--scale", type=int, default=1, help="size of the attacks: 1 takes some minutes, 10 is the original size"
    )
    parser.add_argument("--only", default="", help="run only attacks with this text in their name")
    parser.add_argument(
        "--descriptors", type=int, help="limit of the session's descriptors (default: the system's limit)"
    )
    parser.add_argument("--carrier", choices=["dds", "zenoh"], help="run only the attacks with this carrier")
    given = parser.parse_args()
    carriers = ["dds", "zenoh"] if given.carrier is None else [given.carrier]
    outcomes = [attack_session(given, carrier) for carrier in carriers]
    held = [each for one in outcomes for each in one[0]]
    print(json.dumps({"attacks": len(held), "held": sum(each.well for each in held)}))
    return 0 if all(each.well for each in held) and all(is_whole for _, is_whole in outcomes) else 1


def attack_session(given: argparse.Namespace, carrier: str) -> tuple[list[Held], bool]:
    """Attack a session; return the outcomes, and True if its recording is complete and it printed no traceback."""
    router = free_ports(1)[0] if carrier == "zenoh" else 0
    doors = replace(Doors(*free_ports(7)), ros2=attack_ros2.free_domain(), router=router)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        KeyRing(folder / "keys", utc_now).add("honest", [Right.ADMIN], KEY, None)
        command = [*COMMAND, "play", "study.yaml", "--outside", "TabUI"]
        options = ["--port", str(doors.text), "--watch", str(doors.watch), "--keys", "keys", "--ros"]
        options += ["--ros-master", f"http://{HOST}:{doors.ros}", "--mavlink", "--tcp", f"{HOST}:{doors.tcp}"]
        options += ["--udp-listen", f"{HOST}:{doors.udp}", "--rate", "1", "--bag", "hunt.bag", "--no-report"]
        options += ["--foxglove", str(doors.foxglove), "--ros2", "--ros2-domain", str(doors.ros2)]
        options += ["--carrier", carrier]
        # A recording with a new part every two seconds always needs a free descriptor.
        study = "recording: {split_duration: 2}\n"
        routing: subprocess.Popen[bytes] | None = None
        if doors.router:
            study += f"ros2: {{router: '{HOST}:{doors.router}'}}\n"
            routing = subprocess.Popen(
                [*COMMAND, "ros2", "router", "--listen", f"{HOST}:{doors.router}"], stdout=subprocess.PIPE
            )
            cast("IO[bytes]", routing.stdout).readline()
        (folder / "study.yaml").write_text(study)
        output = folder / "output.txt"
        with output.open("wb") as file:
            session = subprocess.Popen(
                [*command, *options],
                cwd=folder,
                stdout=file,
                stderr=file,
                env={**os.environ, "PYTHONPATH": str(Path.cwd())},
            )
        if given.descriptors:
            resource.prlimit(session.pid, resource.RLIMIT_NOFILE, (given.descriptors, given.descriptors))
        gateway: subprocess.Popen[bytes] | None = None
        try:
            while "join at" not in output.read_text():
                if session.poll() is not None:
                    print(output.read_text())
                    return [], False
                time.sleep(0.1)
            gateway = attack_browsers.serve(folder, doors.web)
            titles = f"{'wait':>10} {'client':<8} {'lag':>9} {'refused':>7} {'closed':>6} {'memory':>10} {'files':>5}"
            print(f"{'attack':<45} {'tries':>7} {titles}  outcome")
            held = assault(doors.with_node(), session, gateway, given.seed, given.scale, given.only, folder)
        finally:
            for process in (gateway, session, routing):
                if process is not None and process.poll() is None:
                    process.send_signal(signal.SIGTERM)
                if process is not None:
                    process.wait(60)
        text = output.read_text() + (folder / "serve.txt").read_text()
        parts = len(list(folder.glob("hunt_*.bag")))
        recorded = parts > 1 and not list(folder.glob("*.active"))
        replayed = recorded and asyncio.run(ended("replay", folder / "hunt.bag")) == 0
    traceback = "Traceback" in text
    whole = f"complete, in {parts} parts" if recorded else "NOT complete"
    whole += ", and its replay is the same" if replayed else ", and its replay FAILED"
    print(f"The recording is {whole}. The session printed {'a TRACEBACK' if traceback else 'no traceback'}.")
    if traceback:
        print(text[text.index("Traceback") - 500 :][:3000])
    if not all(each.running for each in held):
        print("\n".join(line for line in text.splitlines()[-40:] if "Dropping client" not in line))
    return held, replayed and not traceback


if __name__ == "__main__":
    sys.exit(main())
