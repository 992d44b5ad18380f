"""Checks of the TCP ports of sessions: is each port free, or does another program use it?"""

import errno
import shutil
import socket
import subprocess
from collections.abc import Iterator, Mapping
from contextlib import suppress
from pathlib import Path

from thbridge.sockets.addresses import LOCALHOST, ROS_MASTER_PORT, TEXT_SERVER_PORT, WATCH_PORT, parse_address
from thbridge.study.study_file import Study
from ui.commands.doctor.result import HealthCheck, ok, warning

PORTS: Mapping[int, str] = {
    TEXT_SERVER_PORT: "--port",
    WATCH_PORT: "--watch",
    8765: "--foxglove",
    ROS_MASTER_PORT: "--ros-master",
}
"""Ports, each with the option that chooses another port."""
_LISTENS = "0A"
"""State of a listening socket, as Linux writes it in /proc/net/tcp."""


def ports_of_study(study: Study) -> Mapping[int, str]:
    """Return the TCP ports that a session of a study uses, each with the key or option that sets it.

    Port 0 means any free port.
    """
    mavlink = None if study.mavlink.tcp is None or not study.mavlink.on else parse_address(study.mavlink.tcp)
    named = {
        study.server.port: "server.port",
        study.watch.port: "watch.port",
        None if mavlink is None else mavlink.port: "mavlink.tcp",
    }
    others = {port: option for port, option in PORTS.items() if option not in {"--port", "--watch"}}
    return {**others, **{port: key for port, key in named.items() if port}}


def check_ports(ports: Mapping[int, str] = PORTS) -> Iterator[HealthCheck]:
    """Check that no program listens at the ports of sessions."""
    for port, option in ports.items():
        name = f"port {port}"
        with socket.socket() as tried:
            tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            try:
                tried.bind((LOCALHOST, port))
            except OSError as error:
                if error.errno == errno.EADDRINUSE:
                    message = f"used by {holder(port) or 'a program of another account'}"
                else:
                    message = f"not available ({error.strerror})"
                yield warning(name, message, f"End that program, or choose another port with {option}")
                continue
        yield ok(name, "free")


def holder(port: int) -> str | None:
    """Return the name and process id of the program that listens at a port; None if this account cannot see it."""
    if Path("/proc/net/tcp").exists():
        return _by_proc(port)
    lsof = shutil.which("lsof")
    if lsof is None:
        return None
    command = [lsof, "-nP", f"-iTCP:{port}", "-sTCP:LISTEN", "-Fpc"]
    listing = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    fields = {line[0]: line[1:] for line in listing.splitlines() if line}
    return f"{fields['c']} (process {fields['p']})" if {"c", "p"} <= set(fields) else None


def _by_proc(port: int) -> str | None:
    sockets = set()
    for table in ("tcp", "tcp6"):
        with suppress(OSError):
            for line in Path("/proc/net", table).read_text(encoding="ascii").splitlines()[1:]:
                words = line.split()
                if int(words[1].rpartition(":")[2], 16) == port and words[3] == _LISTENS:
                    sockets.add(f"socket:[{words[9]}]")
    for process in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if any(str(file.readlink()) in sockets for file in (process / "fd").iterdir()):
                return f"{(process / 'comm').read_text(errors='replace').strip()} (process {process.name})"
    return None
