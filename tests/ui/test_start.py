"""What commands load before they do anything, and before they do what needs little."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from sim.parameters import RobotParameters, WorldParameters
from sim.robot.costmap.footprint import pad, radii
from tests.support.bags.foreign_bags import Robot, write, write_map
from tests.support.project import ROOT
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.ros.topics import RosMessage, Topic
from ui.commands.offline.plan import INFLATION, RADIUS

HEAVY = {"numpy", "numba", "scipy", "matplotlib", "pyarrow", "pymavlink", "rosbags", "PySide6", "pydantic", "asyncio"}
PROGRAM = """
import sys
from ui.cli import main
sys.argv = ["thbridge", *sys.argv[1:]]
try:
    main()
finally:
    print(*sys.modules, file=open("modules", "w"))
"""


def loaded(folder: Path, *arguments: str, **environment: str) -> set[str]:
    """Names of all modules that are loaded at the end of a command."""
    command = [sys.executable, "-c", PROGRAM, *arguments]
    everything = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    subprocess.run(command, cwd=folder, env=everything, capture_output=True, check=False, timeout=120)
    return set((folder / "modules").read_text().split())


@pytest.mark.parametrize(
    "arguments",
    [
        "--help",
        "plya",
        "bag cutt",
        "play --robts 3",
        "play --help",
        "server --help",
        "bag export --help",
        "mavlink status --nonsense",
        "study init",
        "ros master unexpected",
        "talk --help",
    ],
)
def test_help_and_mistakes_load_nothing_that_a_command_needs(tmp_path: Path, arguments: str) -> None:
    modules = loaded(tmp_path, *arguments.split())
    packages = {name.partition(".")[0] for name in modules}
    assert not packages & HEAVY
    assert not {name for name in modules if name.startswith("sim.")}


def test_a_game_without_a_report_loads_nothing_of_analysis_and_of_other_filters(tmp_path: Path) -> None:
    arguments = ("play", "--headless", "--no-report", "--port", "0", "--max-seconds", "1", "--bag", "a.bag")
    modules = loaded(tmp_path, *arguments)
    assert "thbridge.app.play" in modules
    people = "ui.model.playing", "ui.hosting.terminal"
    assert not {name for name in modules if name.startswith(("thbridge.analysis", "matplotlib", "PySide6"))}
    assert not {name for name in modules if name.startswith(people)}
    unused = "pymavlink", "thbridge.mavlink.vehicle", "thbridge.app.live_graph.live", "ruamel", "scipy.ndimage"
    assert not {name for name in modules if name.startswith(unused)}
    assert not {name for name in modules if name.startswith(("filterpy", "scipy.stats", "sim.robot.localization.ekf"))}


@pytest.mark.parametrize(("kind", "is_loaded"), [("amcl", False), pytest.param("ekf", True, marks=pytest.mark.slow)])
def test_the_particle_filter_loads_nothing_of_other_filters(tmp_path: Path, kind: str, is_loaded: bool) -> None:
    write(tmp_path / "a.bag", Robot(), seconds=1.0)
    command = ("localize", "a.bag", "--map", str(write_map(tmp_path)), "--global")
    modules = loaded(tmp_path, *command, "--localization", kind)
    assert "thbridge.offline.localize" in modules
    assert ("filterpy" in modules) is is_loaded


@pytest.mark.parametrize(
    "words", ["thbridge pl", "thbridge bag c", "thbridge play --ro", "thbridge server --port 1 --"]
)
def test_completion_loads_nothing_that_a_command_needs(tmp_path: Path, words: str) -> None:
    place = str(words.count(" "))
    modules = loaded(tmp_path, _THBRIDGE_COMPLETE="complete_bash", COMP_WORDS=words, COMP_CWORD=place)
    packages = {name.partition(".")[0] for name in modules}
    assert not packages & HEAVY
    assert not {name for name in modules if name.startswith("sim.")}


def test_the_planner_offers_the_radii_of_our_robot() -> None:
    costmap = RobotParameters().global_costmap
    assert radii(pad(np.array(WorldParameters().footprint), costmap.footprint_padding))[0] == RADIUS
    assert costmap.inflation_layer.inflation_radius == INFLATION


def test_a_summary_of_a_bag_and_a_suggestion_load_no_simulator(tmp_path: Path) -> None:
    bag = tmp_path / "a.bag"
    with BagWriter(bag) as writer:
        writer.write(RosMessage(Topic("/chatter", "std_msgs/String"), 1, b"\x01\x00\x00\x00a"))
    costs = ROOT / "templates" / "original-2016" / "mapTimes"
    for command in (["bag", "info", str(bag)], ["suggest", "--costs", str(costs), "--at", "0", "--unvisited", "1,2"]):
        modules = loaded(tmp_path, *command)
        assert not {name.partition(".")[0] for name in modules} & {"numba", "scipy", "matplotlib", "pyarrow", "asyncio"}
        assert not {name for name in modules if name.startswith(("sim.", "thbridge.app"))}
        assert "thbridge.analysis.bag_summary" in modules or "thbridge.hunt.tour" in modules


def test_a_text_server_listens_without_robots_vehicles_and_bags(tmp_path: Path) -> None:
    # A script's shell has the programs that it starts by `&` ignore Ctrl-C; they are stopped by it all the same.
    command = ["sh", "-c", 'trap "" INT; exec "$@"', "sh", sys.executable, "-c", PROGRAM, "server", "--port", "0"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with subprocess.Popen(command, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        assert server.stdout.readline().startswith("listening on")
        server.send_signal(signal.SIGINT)
        server.wait(60)
    modules = set((tmp_path / "modules").read_text().split())
    assert "thbridge.app.server" in modules
    assert not {name.partition(".")[0] for name in modules} & {
        "numba",
        "pymavlink",
        "pyvrp",
        "rosbags",
        "matplotlib",
        "pyarrow",
        "PySide6",
    }
    unwanted = ("sim.team", "sim.world.physics", "sim.robot.localization", "sim.robot.navigator.move_base")
    unwanted += (
        "thbridge.roles.simr",
        "thbridge.mavlink.role",
        "thbridge.ros.publisher",
        "thbridge.recording.bag.writing.writer",
    )
    assert not {name for name in modules if name.startswith(unwanted)}
