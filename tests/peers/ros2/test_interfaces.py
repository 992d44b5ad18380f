"""Type descriptions and hashes are those that rosidl computed, for the types of rclpy's wheels and for our own."""

import json
import os
import subprocess
from pathlib import Path

import pytest

from tests.support.programs.ports import free_domain
from tests.support.project import ROOT
from thbridge.ros2.distribution import Distribution
from thbridge.ros2.hashes import describe, rihs01
from thbridge.ros2.interface_texts import JAZZY_TEXTS
from thbridge.ros2.interfaces import messages_in, parsed

ROS2 = ROOT / ".peers" / "ros2"
SHARE = ROS2 / "share"
KINDS = ("msg", "srv", "action")
BUILT = ("thbridge_msgs", "nav2_msgs", "tf2_msgs")
"""Packages without wheels, which scripts/peers/ros2_interfaces.py builds."""

pytestmark = pytest.mark.skipif(
    not (ROS2 / "installed").exists(), reason="not installed: ros2 (see scripts/install_peers.sh)"
)


def described(*packages: str) -> list[dict]:
    """The descriptions that rosidl has written, of all packages or of these."""
    files = sorted(file for kind in KINDS for file in SHARE.glob(f"*/{kind}/*.json"))
    return [json.loads(file.read_text()) for file in files if not packages or file.parts[-3] in packages]


def test_descriptions_of_all_shipped_definitions_are_those_of_rosidl() -> None:
    texts: dict[str, str] = {}
    for kind in KINDS:
        for file in SHARE.glob(f"*/{kind}/*.{kind}"):
            texts |= messages_in(f"{file.parts[-3]}/{kind}/{file.stem}", file.read_text())
    compared, skipped = 0, set()
    for theirs in described():
        name = theirs["type_description_msg"]["type_description"]["type_name"]
        if name not in texts:
            skipped.add(name.partition("/")[0])
            continue
        ours = describe(name, lambda each: parsed(each, texts[each]))
        assert ours == theirs["type_description_msg"]
        assert {"type_name": name, "hash_string": rihs01(ours)} == theirs["type_hashes"][0]
        compared += 1
    # The files of the packages that we build are not installed, and some types of test_msgs are defined in IDL.
    assert skipped <= {*BUILT, "test_msgs"}
    assert compared > 150


def test_hashes_of_all_types_of_kilted_are_those_of_the_wheels() -> None:
    kilted = Distribution.of("kilted")
    known = 0
    for theirs in described():
        name, described_hash = theirs["type_hashes"][0].values()
        try:
            ours = kilted.message(name).hash
        except KeyError:
            continue
        assert ours == described_hash, name
        assert kilted.description(name) == theirs["type_description_msg"], name
        known += 1
    assert known > 200


@pytest.mark.skipif(not (ROS2 / "interfaces" / "made_from").exists(), reason="interfaces of ROS 2 were not built")
@pytest.mark.parametrize("package", BUILT)
def test_packages_without_wheels_have_the_hashes_that_rosidl_computed(package: str) -> None:
    kilted = Distribution.of("kilted")
    hashes = [tuple(theirs["type_hashes"][0].values()) for theirs in described(package)]
    assert hashes
    assert [(name, kilted.message(name).hash) for name, _ in hashes] == hashes


def test_the_types_of_jazzy_have_the_hashes_that_rosidl_computes(tmp_path: Path) -> None:
    for name, text in JAZZY_TEXTS.items():
        package, kind, word = name.split("/")
        if package == "nav2_msgs":
            (tmp_path / package / kind).mkdir(parents=True, exist_ok=True)
            (tmp_path / package / kind / f"{word}.{kind}").write_text(text)
    program = (
        "import sys; from pathlib import Path; sys.path[0] = 'scripts/peers'; from ros2_interfaces import describe; "
        "describe(Path(sys.argv[1]), Path(sys.argv[2]) / 'nav2_msgs')"
    )
    arguments = [ROS2 / "bin" / "python", "-c", program, tmp_path / "nav2_msgs", tmp_path / "out"]
    subprocess.run(arguments, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    jazzy, compared = Distribution.of("jazzy"), 0
    for file in (tmp_path / "out").rglob("*.json"):
        name, theirs = json.loads(file.read_text())["type_hashes"][0].values()
        assert jazzy.message(name).hash == theirs, name
        compared += 1
    assert compared > 40


def test_types_have_the_sources_that_a_node_of_rclpy_names() -> None:
    kilted = Distribution.of("kilted")
    names = ("nav_msgs/msg/Odometry", "std_srvs/srv/SetBool", "nav_msgs/srv/GetMap")
    arguments = [argument for name in names for argument in (name, kilted.message(name).hash)]
    domain = {"ROS_DOMAIN_ID": str(free_domain()), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    command = [ROS2 / "bin" / "python", Path(__file__).with_name("rclpy_type_sources.py"), *arguments]
    asked = subprocess.run(
        command, env={**os.environ, **domain}, capture_output=True, text=True, timeout=60, check=False
    )
    assert asked.returncode == 0, asked.stderr
    for name, line in zip(names, asked.stdout.splitlines(), strict=True):
        assert json.loads(line) == [list(source[:2]) for source in kilted.sources(name)]
