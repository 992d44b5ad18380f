"""Two machines for tests, with a cable between them: network namespaces of this one, as `unshare` makes them."""

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

_NEEDED = ("unshare", "nsenter", "ip")
_CABLE = """
unshare -n sh -c 'echo $$ > there; exec sleep 600' &
while ! [ -s there ]; do sleep 0.05; done
beyond="nsenter -t $(cat there) -n"
ip link add name cable0 type veth peer name cable1
ip link set cable1 netns $(cat there)
ip address add 10.9.0.1/24 dev cable0
$beyond ip address add 10.9.0.2/24 dev cable1
ip link set lo up && ip link set cable0 up && $beyond ip link set lo up && $beyond ip link set cable1 up && touch ready
wait
"""
_CAPTURE = """
import socket, sys
cable = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.ntohs(3))
cable.bind(("cable0", 0))
with open(sys.argv[1], "wb", buffering=0) as file:
    while True:
        file.write(cable.recv(1 << 16))
"""


@dataclass(frozen=True)
class TwoMachines:
    """Two machines.

    Attributes:
        here: command that runs another on the machine 10.9.0.1.
        there: command that runs another on the machine 10.9.0.2.
        traffic: file of all that goes over the cable.
    """

    here: tuple[str, ...]
    there: tuple[str, ...]
    traffic: Path


@contextmanager
def two_machines(folder: Path) -> Iterator[TwoMachines]:
    """Connect two machines; the test is skipped where this one cannot be two."""
    missing = [each for each in _NEEDED if shutil.which(each) is None]
    if missing:
        pytest.skip(f"{missing[0]} is not installed")
    # Root needs no namespace of users, which there are not everywhere, and others cannot do without.
    alone = [] if os.geteuid() == 0 else ["-r"]
    cable = subprocess.Popen(
        ["unshare", *alone, "-n", "sh", "-c", _CABLE], cwd=folder, stderr=subprocess.PIPE, start_new_session=True
    )
    capture = None
    try:
        end = time.monotonic() + 10
        while not (folder / "ready").exists():
            if cable.poll() is not None or time.monotonic() > end:
                cable.kill()
                assert cable.stderr is not None
                pytest.skip(f"no network namespaces: {cable.stderr.read().decode().strip()}")
            time.sleep(0.05)
        enter = ("nsenter", *(("-U", "--preserve-credentials") if alone else ()), "-n", "-t")
        there = (*enter, (folder / "there").read_text().strip())
        here = (*enter, str(cable.pid))
        traffic = folder / "traffic"
        capture = subprocess.Popen([*here, sys.executable, "-c", _CAPTURE, str(traffic)])
        while not traffic.exists():
            assert capture.poll() is None
            time.sleep(0.05)
        yield TwoMachines(here, there, traffic)
    finally:
        for each in (capture, cable):
            if each is not None:
                each.kill()
                each.wait(10)
        if (folder / "there").exists():
            subprocess.run(["kill", "-9", (folder / "there").read_text().strip()], check=False)
