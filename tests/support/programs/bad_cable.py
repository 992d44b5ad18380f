"""Two machines with a bad cable between them: it delays packets, loses some, or is cut.

The machines are network namespaces of this one. The cable is a program between two TUN devices, because not every
kernel has the queueing discipline `netem`. It needs root.
"""

import ctypes
import fcntl
import heapq
import json
import os
import random
import select
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

HERE, THERE = "10.9.0.1", "10.9.0.2"
"""Addresses of the two machines."""
_TUNSETIFF, _TUN_WITHOUT_HEADER = 0x400454CA, 0x1001
_NEW_NETWORK = 0x40000000
_LONGEST = 65535


class BadCable:
    """Cable between two machines.

    Args:
        process: program of the cable, on the machine `HERE`.

    Attributes:
        there: number of a process on the machine `THERE`.
        here_by, there_by: commands that run another command on a machine.
        address: present address of the machine `THERE`.
    """

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        self._process = process
        assert process.stdout is not None
        self.there = int(process.stdout.readline())
        self.here_by = ("nsenter", "-n", "-t", str(process.pid))
        self.there_by = ("nsenter", "-n", "-t", str(self.there))
        self.address = THERE

    def set(self, delay: float = 0.0, loss: float = 0.0, *, cut: bool = False) -> None:
        """Delay all further packets by these seconds, and lose this share of them, or all if the cable is cut."""
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps([delay, 1.0 if cut else loss]) + "\n")
        self._process.stdin.flush()

    def change_address(self, address: str) -> None:
        """Give another address to the machine `THERE`, as another network does."""
        for words in (("del", f"{self.address}/24"), ("add", f"{address}/24")):
            subprocess.run([*self.there_by, "ip", "address", *words, "dev", "cable1"], check=True)
        self.address = address

    def dial(self, port: int, *, far: bool = True) -> socket.socket:
        """Return a socket connected to a port of `HERE`: a socket of `THERE`, or of the same machine if not `far`."""
        made: list[socket.socket | OSError] = []
        process = self.there if far else self._process.pid

        def connect() -> None:
            # Each thread has its own network.
            with Path(f"/proc/{process}/ns/net").open() as network:
                assert ctypes.CDLL(None, use_errno=True).setns(network.fileno(), _NEW_NETWORK) == 0
            try:
                made.append(socket.create_connection((HERE, port), 5.0))
            except OSError as error:
                made.append(error)

        thread = threading.Thread(target=connect)
        thread.start()
        thread.join()
        (result,) = made
        if isinstance(result, OSError):
            raise result
        return result


@contextmanager
def bad_cable() -> Iterator[BadCable]:
    """Connect two machines by a cable without faults; the test is skipped where this is not possible."""
    if os.geteuid() != 0:
        pytest.skip("two networks need root")
    process = subprocess.Popen(
        ["unshare", "-n", sys.executable, __file__],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None
    assert process.stderr is not None
    try:
        if not select.select([process.stdout], [], [], 20)[0] or process.poll() is not None:
            process.kill()
            pytest.skip(f"no networks of their own: {process.stderr.read().strip()[-200:]}")
        yield BadCable(process)
    finally:
        process.kill()
        process.wait()


def _device(name: str) -> int:
    device = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(device, _TUNSETIFF, struct.pack("16sH", name.encode(), _TUN_WITHOUT_HEADER))
    return device


def _other_network() -> "subprocess.Popen[bytes]":
    """Return a process with its own network; it ends when its input ends."""
    process = subprocess.Popen(["unshare", "-n", "cat"], stdin=subprocess.PIPE)
    own, other = Path("/proc/self/ns/net"), Path(f"/proc/{process.pid}/ns/net")
    while own.readlink() == other.readlink():
        time.sleep(0.01)
    return process


def _run(*words: str) -> None:
    subprocess.run(words, check=True)


def main() -> None:
    """Carry packets between two devices; each line of the input is a list of the delay and the share that is lost."""
    devices = [_device("cable0"), _device("cable1")]
    there = _other_network()
    beyond = ("nsenter", "-n", "-t", str(there.pid))
    _run("ip", "link", "set", "cable1", "netns", str(there.pid))
    for by, name, address in (((), "cable0", HERE), (beyond, "cable1", THERE)):
        _run(*by, "ip", "address", "add", f"{address}/24", "dev", name)
        _run(*by, "ip", "link", "set", name, "up")
        _run(*by, "ip", "link", "set", "lo", "up")
    print(there.pid, flush=True)
    delay, loss = 0.0, 0.0
    drawn = random.Random(1)
    waiting: list[tuple[float, int, int, bytes]] = []
    count = 0
    while True:
        timeout = max(0.0, waiting[0][0] - time.monotonic()) if waiting else None
        for ready in select.select([*devices, sys.stdin], [], [], timeout)[0]:
            if ready is sys.stdin:
                line = sys.stdin.readline()
                if not line:
                    return
                delay, loss = json.loads(line)
                continue
            packet = os.read(ready, _LONGEST)
            count += 1
            if drawn.random() >= loss:
                heapq.heappush(waiting, (time.monotonic() + delay, count, devices[ready == devices[0]], packet))
        while waiting and waiting[0][0] <= time.monotonic():
            _, _, device, packet = heapq.heappop(waiting)
            os.write(device, packet)


if __name__ == "__main__":
    main()
