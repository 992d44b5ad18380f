"""Take a picture of rviz next to a running hunt: `docs/pictures/rviz.png`.

Run this script from the project's folder: `.venv/bin/python scripts/draw/rviz.py`. It plays a hunt on a separate ROS
graph, starts rviz on an invisible screen (Xvfb) with the configuration of `thbridge ros rviz`, waits some seconds, and
takes the picture. It needs Debian's rviz, xvfb and imagemagick.
"""

import argparse
import os
import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import mkdtemp

ROOT = Path(__file__).parents[2]
SCREEN = "1300x940x24"
NEEDED = ("rviz", "Xvfb", "import")
THBRIDGE = (sys.executable, "-c", "from ui.cli import main; main()")


def free_port() -> int:
    """Return a free TCP port."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


@contextmanager
def running(command: list[str], environment: dict[str, str], log: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Run a program until the end of the block."""
    with log.open("wb") as output:
        process = subprocess.Popen(command, env=environment, stdout=output, stderr=subprocess.STDOUT, cwd=ROOT)
        try:
            yield process
        finally:
            process.terminate()
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def wait_for_port(port: int, timeout: float) -> None:
    """Wait until a server listens on the port. Raise TimeoutError at the end of the timeout."""
    end = time.monotonic() + timeout
    while time.monotonic() < end:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.2)
    raise TimeoutError(f"no server listens on port {port}")


def draw(picture: Path, robots: int, seconds: float, folder: Path) -> None:
    """Play a hunt, show it in rviz and take the picture; logs stay in the folder."""
    port = free_port()
    uri = f"http://127.0.0.1:{port}"
    display = f":{90 + os.getpid() % 900}"
    ours = {**os.environ, "ROS_MASTER_URI": uri, "PYTHONPATH": str(ROOT)}
    # Debian's programs must not find this environment's packages.
    theirs = {name: value for name, value in ours.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV", "PYTHONHOME")}
    theirs |= {"DISPLAY": display, "ROS_IP": "127.0.0.1", "LIBGL_ALWAYS_SOFTWARE": "1", "HOME": str(folder)}
    theirs |= {"XDG_RUNTIME_DIR": str(folder)}
    configuration = folder / "team.rviz"
    written = [*THBRIDGE, "ros", "rviz", "--robots", str(robots), "--to", str(configuration)]
    subprocess.run(written, env=ours, cwd=ROOT, check=True)
    hunt = [*THBRIDGE, "play", "--headless", "--ros", "--robots", str(robots), "--bag", str(folder / "hunt.bag")]
    with (
        running(["Xvfb", display, "-screen", "0", SCREEN], theirs, folder / "xvfb.log"),
        running([*hunt, "--no-report", "--port", "0"], ours, folder / "play.log"),
    ):
        wait_for_port(port, 120.0)
        with running(["rviz", "-d", str(configuration)], theirs, folder / "rviz.log"):
            time.sleep(seconds)
            subprocess.run(["import", "-window", "root", str(picture)], env=theirs, check=True)


def main() -> None:
    """Read the command line and draw."""
    parser = argparse.ArgumentParser(description="Take a picture of rviz next to a running hunt.")
    parser.add_argument("--robots", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=25.0, help="seconds to wait before the picture (default 25)")
    parser.add_argument("--to", type=Path, default=ROOT / "docs" / "pictures" / "rviz.png")
    parser.add_argument("--logs", type=Path, help="folder of the programs' logs (default: a new folder)")
    options = parser.parse_args()
    missing = [program for program in NEEDED if shutil.which(program) is None]
    if missing:
        sys.exit(f"These programs are not installed: {', '.join(missing)}. Run: apt-get install rviz xvfb imagemagick")
    # A file with a fixed name could already belong to another account.
    logs = options.logs or Path(mkdtemp(prefix="draw_rviz-"))
    logs.mkdir(parents=True, exist_ok=True)
    print(f"logs: {logs}")
    draw(options.to, options.robots, options.seconds, logs)
    print(options.to)


if __name__ == "__main__":
    main()
