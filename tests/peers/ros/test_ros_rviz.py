"""rviz beside a hunt, with the configuration that we write for it, on a screen that nobody sees."""

import shutil
import subprocess
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sim.numerics.float_array import FloatArray
from tests.peers.ros_programs import Ros
from tests.support.programs.peer_programs import RestartedPeer
from tests.support.programs.ports import free_port
from tests.support.programs.processes import THBRIDGE, Program, until
from tests.support.windows.desktop import x_server
from thbridge.ros.rviz import COLOURS

NEEDED = ("rviz", "Xvfb", "import")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        any(shutil.which(program) is None for program in NEEDED),
        reason=f"not installed: {', '.join(NEEDED)} (rviz, xvfb, imagemagick; see scripts/install_peers.sh)",
    ),
]

ROBOTS = 2
NEAR = 12
"""How far a color on the screen may be from the one in the file, of 255."""
HARMLESS = ("media_export", "indexed_8bit_image")
"""What rviz complains of with no data at all: of Debian's packages, and of a screen without a graphics card."""


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """What is to be seen, and what rviz says to it.

    Attributes:
        pixels: the picture, (rows, columns, 3) of 0 to 255.
        log: of rviz.
    """

    pixels: FloatArray
    log: str

    @property
    def has_walls(self) -> bool:
        """Whether the outer walls are there: lines that go through most of the view."""
        dark = (self.pixels.max(axis=2) < 120) & (np.ptp(self.pixels, axis=2) < 10)
        return bool((dark.sum(axis=0) > 500).sum() >= 4 and (dark.sum(axis=1) > 600).sum() >= 4)

    def count(self, colour: str) -> int:
        """How many pixels have a color, given as rviz writes it."""
        wanted = np.array([float(part) for part in colour.split(";")])
        return int((np.abs(self.pixels - wanted).max(axis=2) <= NEAR).sum())


def look(ros: Ros, picture: Path) -> FloatArray:
    subprocess.run(["import", "-window", "root", str(picture)], env=ros.environment, check=True)
    with Image.open(picture) as image:
        return np.asarray(image.convert("RGB"), dtype=np.float64)


@pytest.fixture(scope="module")
def sight(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Sight]:
    folder = tmp_path_factory.mktemp("rviz")
    folder.chmod(0o700)
    port, log = free_port(), folder / "rviz.log"
    ros = Ros(port, folder)
    ros.environment |= {"LIBGL_ALWAYS_SOFTWARE": "1", "HOME": str(folder), "XDG_RUNTIME_DIR": str(folder)}
    configuration = folder / "team.rviz"
    written = [*THBRIDGE, "ros", "rviz", "--robots", str(ROBOTS), "--to", str(configuration)]
    subprocess.run(written, check=True, capture_output=True)
    with ExitStack() as opened:
        ros.environment["DISPLAY"] = opened.enter_context(x_server(1300, 940))
        uri = f"http://127.0.0.1:{port}"
        played = ("play", "--headless", "--participant", "suggestion", "--no-report", "--port", "0")
        hunt = Program(folder, *played, "--robots", str(ROBOTS), "--ros", "--ros-master", uri, "--bag", "hunt.bag")
        opened.callback(hunt.close)
        until("the hunt", lambda: "leaves for" in hunt.text, [hunt])

        def start_rviz() -> subprocess.Popen[bytes]:
            command = ["rviz", "-d", configuration]
            with log.open("wb") as output:
                rviz = subprocess.Popen(command, env=ros.environment, stdout=output, stderr=subprocess.STDOUT)
            opened.callback(rviz.wait)
            opened.callback(rviz.kill)  # It takes its time to go by itself.
            return rviz

        def read_log() -> str:
            return log.read_text(errors="replace")

        # rviz 1.14 of Debian now and then crashes by a fault of its own (SIGSEGV, SIGABRT) before it draws anything.
        rviz = RestartedPeer("rviz", start_rviz, read_log)

        plans = [COLOURS[robot] for robot in range(ROBOTS)]
        seen: list[Sight] = []

        def is_drawn() -> bool:
            rviz.keep_running()
            seen[:] = [Sight(look(ros, folder / "rviz.png"), read_log())]
            return seen[0].has_walls and all(seen[0].count(colour) > 300 for colour in plans)

        try:
            until("the map and both robots to be drawn", is_drawn, [hunt], 150.0)
        except TimeoutError as late:
            late.add_note(f"--- rviz\n{read_log()}")
            raise
        yield seen[0]


@pytest.mark.parametrize("robot", range(ROBOTS))
def test_every_robot_is_drawn_in_its_colour(sight: Sight, robot: int) -> None:
    assert sight.count(COLOURS[robot]) > 300


def test_the_maps_walls_are_drawn(sight: Sight) -> None:
    assert sight.has_walls


def test_rviz_has_nothing_to_complain_of(sight: Sight) -> None:
    complaints = [line for line in sight.log.splitlines() if "ERROR" in line or "WARN" in line]
    assert [line for line in complaints if not any(word in line for word in HARMLESS)] == []
