"""The first day of a laboratory on the page about real robots: its commands, with robots of rclpy."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from textwrap import dedent

import pytest

from tests.peers.ros2.action_scripts import NEEDS_RCLPY
from tests.peers.ros2.peer_process import PYTHON, environment
from tests.support.programs.ports import free_domain
from tests.support.programs.processes import Program, port_of, run_thbridge, until
from tests.support.project import ROOT

pytestmark = [NEEDS_RCLPY, pytest.mark.slow]
DRY, LAB = free_domain(), free_domain()
PAGE = ROOT / "docs" / "how-to" / "real-robots.md"
ROBOTS = Path(__file__).with_name("nav2_robots.py")
HERE = {
    "dry.yaml": (("domain: 77", f"domain: {DRY}"),),
    "lab.yaml": (
        ("domain: 7, host: 192.168.1.5", f"domain: {LAB}"),
        ("open_to: [192.168.1.0/24]\n", ""),
    ),
}
"""What the files of the page say, and what the network of the test needs."""
_BLOCK = re.compile(r"^   ```(sh|yaml)\n(.*?)^   ```$", re.MULTILINE | re.DOTALL)


def commands(block: str) -> list[list[str]]:
    words = [shlex.split(line.replace("--ros2-domain 77", f"--ros2-domain {DRY}")) for line in block.splitlines()]
    assert all(each[0] == "thbridge" for each in words)
    return [each[1:] for each in words]


def play(folder: Path, block: str) -> None:
    """Start the programs in the order of the page, until a simulated participant has played; then end them."""
    programs: list[Program] = []
    server = ""
    try:
        for words in commands(block):
            if words[0] == "server":
                programs.append(Program(folder, *words, "--port", "0"))
                server = f"127.0.0.1:{port_of(programs[-1], programs)}"
            elif "--server" in words:
                programs.append(Program(folder, *words))
            else:
                programs.append(Program(folder, *words, "--server", server, *["--json"] * (words[0] == "tabui")))
        player = programs[-1]
        until("the game to be over", lambda: player.process.poll() is not None, programs, 200.0)
        assert player.process.returncode == 0, player.text
        assert '"rooms_visited": 2' in player.text
        assert [each.stop() for each in reversed(programs[:-1])] == [0] * (len(programs) - 1)
    finally:
        for each in programs:
            each.close()


def succeed(folder: Path, block: str) -> None:
    for words in commands(block):
        done = run_thbridge(folder, *words)
        assert done.returncode == 0, done.stderr


def test_a_laboratory_gets_from_its_map_to_its_first_hunt(tmp_path: Path) -> None:
    section = PAGE.read_text().split("## A first day with Nav2 robots")[1].split("\n## ")[0]
    blocks = [(kind, dedent(block)) for kind, block in _BLOCK.findall(section)]
    files = [block for kind, block in blocks if kind == "yaml"]
    make, check, dry_run, look, hunt, report = (block for kind, block in blocks if kind == "sh")
    shutil.copytree(ROOT / "maps" / "practice", tmp_path / "nav2")
    for text in files:
        name = text.split()[1]
        for said, ours in HERE[name]:
            assert said in text
            text = text.replace(said, ours)  # noqa: PLW2901
        (tmp_path / name).write_text(text)
    succeed(tmp_path, make)
    succeed(tmp_path, check)
    play(tmp_path, dry_run)
    assert (tmp_path / "dry.mcap").exists()

    (words,) = commands(look)
    looking = Program(tmp_path, *words)
    robots: subprocess.Popen[bytes] | None = None
    try:
        until("what is missing", lambda: "robot 2 is not ready yet" in looking.text, [looking])
        assert "/robot1/navigate_to_pose" in looking.text
        robots = subprocess.Popen([PYTHON, ROBOTS, "3.0", "1", "2"], env=environment(LAB), stderr=sys.stderr)
        until("the robots", lambda: "All robots have been found." in looking.text, [looking])
        until("it to look for a game", lambda: "127.0.0.1:9" in looking.text, [looking])
        assert looking.stop() == 0
        play(tmp_path, hunt)
    finally:
        looking.close()
        if robots is not None:
            robots.kill()
            robots.wait()
    succeed(tmp_path, report)
