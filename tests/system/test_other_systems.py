"""Other systems: macOS lacks some of Linux's calls, and Windows is told where the program runs."""

import subprocess
import sys
from pathlib import Path

import pytest

WITHOUT_CALLS = """
import os, resource, select, signal, socket, sys, time

# Not on macOS, by the availability notes of Python's documentation.
LACKING = {
    os: ["copy_file_range", "eventfd", "fdatasync", "getresuid", "memfd_create", "pidfd_open", "pipe2", "posix_fadvise",
         "posix_fallocate", "sched_getaffinity", "sched_setaffinity", "setresuid", "splice"],
    select: ["epoll"],
    signal: ["pidfd_send_signal", "sigtimedwait", "sigwaitinfo"],
    socket: ["AF_NETLINK", "MSG_NOSIGNAL", "SOCK_CLOEXEC", "SOCK_NONBLOCK", "SO_PEERCRED", "TCP_KEEPIDLE",
             "TCP_USER_TIMEOUT"],
    resource: ["prlimit"],
    time: ["CLOCK_BOOTTIME"],
}
for module, names in LACKING.items():
    for name in names:
        if hasattr(module, name):
            delattr(module, name)

from ui.start import main

main()
"""
ON_WINDOWS = """
import sys

sys.platform = "win32"
sys.modules["fcntl"] = None
from ui.start import main

main()
"""


def run(program: str, folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", program, *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_a_hunt_on_a_ros_graph_without_the_calls_that_macos_lacks(tmp_path: Path) -> None:
    play = ("play", "--headless", "--map", "practice", "--robots", "1", "--rate", "0", "--bag", "a.bag")
    done = run(WITHOUT_CALLS, tmp_path, *play, "--ros", "--watch", "0", "--max-seconds", "120", "--json")
    assert (done.returncode, done.stderr.count("Traceback")) == (0, 0), done.stderr
    checked = run(WITHOUT_CALLS, tmp_path, "bag", "check", "a.bag")
    assert checked.returncode == 0, checked.stderr


@pytest.mark.slow
def test_a_sweep_without_the_calls_that_macos_lacks(tmp_path: Path) -> None:
    (tmp_path / "short.yaml").write_text("base: {map: practice, robots: 1}\nreplicates: 2\nmax_seconds: 5\n")
    done = run(WITHOUT_CALLS, tmp_path, "sweep", "run", "short.yaml")
    assert (done.returncode, done.stderr.count("Traceback")) == (0, 0), done.stderr


def test_a_computer_is_checked_without_the_calls_that_macos_lacks(tmp_path: Path) -> None:
    done = run(WITHOUT_CALLS, tmp_path, "doctor")
    assert (done.returncode, done.stderr) == (0, "")


def test_windows_is_told_where_the_program_runs(tmp_path: Path) -> None:
    done = run(ON_WINDOWS, tmp_path, "play")
    assert done.returncode == 1
    assert done.stderr.startswith("thbridge runs on Linux and macOS. On Windows, install WSL 2 (`wsl --install`")
    assert done.stdout == ""
