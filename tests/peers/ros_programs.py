"""ROS 1's own programs, and sessions that they are to sit beside."""

import json
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.support.programs.peer_programs import run_peer, skipping_if_crashed
from tests.support.programs.ports import free_port
from tests.support.programs.processes import Program, until

PYTHON = "/usr/bin/python3"
NEEDED = ("rosbag", "rostopic", "rosnode", "rosparam", "rosservice")


def knows(*modules: str) -> bool:
    # Only looked for, since every process that collects tests asks: to import rospy takes half a second.
    asked = [PYTHON, "-c", f"from importlib.util import find_spec; assert all(map(find_spec, {modules}))"]
    return (
        Path(PYTHON).exists() and subprocess.run(asked, capture_output=True, env=clean(), check=False).returncode == 0
    )


def clean() -> dict[str, str]:
    # Debian's Python must not see this environment's packages; and rviz is to be seen, unlike the windows of tests.
    hidden = ("PYTHONPATH", "PYTHONHOME", "VIRTUAL_ENV", "QT_QPA_PLATFORM")
    return {name: value for name, value in os.environ.items() if name not in hidden}


NEEDS_ROS = pytest.mark.skipif(
    any(shutil.which(tool) is None for tool in NEEDED) or not knows("rospy", "actionlib", "tf2_ros", "move_base_msgs"),
    reason=f"not installed: {', '.join(NEEDED)}, python3-actionlib, python3-tf2-ros (see scripts/install_peers.sh)",
)

PATIENCE = 180.0


class Ros:
    """ROS's programs at the master of a session."""

    def __init__(self, port: int, folder: Path) -> None:
        self.environment = {
            **clean(),
            "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
            "ROS_IP": "127.0.0.1",
            "ROS_LOG_DIR": str(folder),
            "ROS_HOME": str(folder),
            "PYTHONUNBUFFERED": "1",
        }

    def says(self, *command: str) -> str:
        done = run_peer(command, env=self.environment, timeout=PATIENCE)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def script(self, text: str, *arguments: str) -> object:
        return json.loads(self.says(PYTHON, "-c", text, *arguments).splitlines()[-1])

    @contextmanager
    def running(self, *command: str, cwd: Path | None = None) -> Iterator[subprocess.Popen[str]]:
        process = subprocess.Popen(
            command, env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            cwd=cwd, start_new_session=True,
        )  # fmt: skip
        try:
            with skipping_if_crashed(command[0], process):
                yield process
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGINT)
                process.wait(90)
            if process.stdout is not None:
                process.stdout.close()


@contextmanager
def session(folder: Path, *arguments: str) -> Iterator[tuple[Ros, Program]]:
    """The robots, on a graph of which they are the master; nobody plays, for there is no text server."""
    port, nowhere = free_port(), f"127.0.0.1:{free_port()}"
    uri = f"http://127.0.0.1:{port}"
    robots = Program(folder, "simr", "--server", nowhere, "--ros", "--ros-master", uri, *arguments)
    ros = Ros(port, folder)
    try:
        until("the session to be on the graph", lambda: "this program is the master" in robots.text, [robots])
        ros.says("rostopic", "echo", "-n", "1", "/robot1/odom/header/seq")
        yield ros, robots
    finally:
        robots.close()
