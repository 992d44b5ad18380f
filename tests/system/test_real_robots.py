"""From simulation to hardware: one process has robots on a ROS graph, the programs of the game command them there."""

import json
from dataclasses import dataclass
from pathlib import Path

import pytest

from tests.support.programs.ports import free_domain, free_port
from tests.support.programs.processes import Program, journal, kinds, port_of, until
from thbridge.recording.bag.reading import reader as bag_reader
from thbridge.ros import names
from thbridge.ros.messages import types, unpack

pytestmark = pytest.mark.slow


@dataclass(frozen=True, slots=True)
class Graph:
    """A ROS graph.

    Attributes:
        study: keys of the study with real robots.
        simulated: arguments of the program with simulated robots.
        real: arguments of the program that commands them.
        joined: text of the first program when its robots are on the graph.
        action: name of the robots' action.
    """

    study: str
    simulated: tuple[str, ...]
    real: tuple[str, ...]
    joined: str
    action: str


def ros1() -> Graph:
    master = "--ros-master", f"http://127.0.0.1:{free_port()}"
    return Graph("robots_from: ros", ("--ros", *master), master, "this program is the master", "move_base")


def ros2(more: str = "") -> Graph:
    domain = free_domain()
    study = f"robots_from: ros2\nros2: {{domain: {domain}, use_sim_time: true{more}}}"
    return Graph(study, ("--ros2",), (), f"ROS 2: Jazzy in domain {domain}", "navigate_to_pose")


@pytest.mark.parametrize("carrier", ["ros", "dds", "zenoh"])
def test_a_whole_hunt_with_robots_of_another_process(carrier: str, tmp_path: Path) -> None:
    bag = tmp_path / "real.bag"
    programs: list[Program] = []

    def start(*arguments: str) -> Program:
        programs.append(Program(tmp_path, *arguments))
        return programs[-1]

    try:
        if carrier == "zenoh":
            router = start("ros2", "router", "--listen", f"127.0.0.1:{free_port()}")
            graph = ros2(f", carrier: zenoh, router: '127.0.0.1:{port_of(router, programs)}'")
        else:
            graph = ros1() if carrier == "ros" else ros2()
        (tmp_path / "study.yaml").write_text(f"robots: 2\n{graph.study}\n")
        simulated = ("--robots-from", "sim", *graph.simulated, "--rate", "3", "--server", "127.0.0.1:9")
        field, server = start("simr", "study.yaml", *simulated), start("server", "--port", "0")
        at = f"127.0.0.1:{port_of(server, programs)}"
        until("the robots to be on the graph", lambda: graph.joined in field.text, programs)
        simr = start("simr", "--study", "study.yaml", *graph.real, "--server", at, "--bag", str(bag))
        until("all robots to be found", lambda: "All robots have been found" in simr.text, programs)
        start("hider", "--server", at)
        player = start("tabui", "--server", at, "--json")
        until("the game to be over", lambda: player.process.poll() is not None, programs, 280.0)
        assert json.loads(player.text.splitlines()[-1])["rooms_visited"] == 8
        assert "reported" not in kinds(tmp_path)
        assert simr.stop() == 0
        replay = start("replay", str(bag))
        assert replay.process.wait(60) == 2
        assert "its robots were real" in replay.text
    finally:
        for program in programs:
            program.close()
    recorded = {topic.name: topic for topic in bag_reader.info(bag).topics}
    assert recorded["/robot1/odom"].messages > 1000
    assert "/robot1/base_pose_ground_truth" not in recorded
    assert names.CLOCK not in recorded
    arrived = [event for event in journal(tmp_path) if event["event"] == "arrived"]
    ends = list(bag_reader.messages(bag, [f"/robot{number}/{graph.action}/result" for number in (1, 2)]))
    assert len(arrived) == 8
    assert [unpack.move_base_result(end.data).status for end in ends] == [3] * 8
    first = next(bag_reader.messages(bag))
    assert (first.topic, first.msgtype) == (names.SESSION, types.SESSION)
    assert graph.study.splitlines()[0] in unpack.session(first.data).study


def test_real_robots_are_recorded_from_the_yes_on_with_what_is_latched(tmp_path: Path):
    uri = f"http://127.0.0.1:{free_port()}"
    (tmp_path / "consent.txt").write_text("We record what you do.")
    (tmp_path / "study.yaml").write_text("robots_from: ros\nrobots: 1\nparticipant: {consent: consent.txt}\n")
    field = Program(tmp_path, "simr", "--robots", "1", "--ros", "--ros-master", uri, "--server", "127.0.0.1:9")
    server = Program(tmp_path, "server", "study.yaml", "--port", "0")
    programs = [field, server]
    try:
        at = f"127.0.0.1:{port_of(server, programs)}"
        until("the robot to be on the graph", lambda: "this program is the master" in field.text, programs)
        words = ("--study", "study.yaml", "--ros-master", uri, "--server", at, "--bag", "real.bag")
        simr = Program(tmp_path, "simr", *words)
        programs.append(simr)
        until("the question", lambda: "nothing is recorded until" in simr.text, programs)
        assert list(tmp_path.glob("real*")) == []
        programs += [Program(tmp_path, "hider", "--server", at), Program(tmp_path, "tabui", "--server", at, "--json")]
        assert "no ROS master" not in simr.text, "it was there from the first look on"
        until("the robot to be recorded", lambda: "departed" in kinds(tmp_path), programs)
        until("the bag", lambda: bool(list(tmp_path.glob("real*"))), programs)
        until("an arrival", lambda: "arrived" in kinds(tmp_path), programs)
        field.kill()
        until("the silence", lambda: "robot 1: it is silent: no more odometry" in simr.text, programs)
        programs.append(field.again())
        until("the robot again", lambda: "its odometry is back" in simr.text, programs)
        assert "is registered with the ROS master" in simr.text, "the simulation was the master"
        assert simr.stop() == 0
    finally:
        for program in programs:
            program.close()
    recorded = [message.topic for message in bag_reader.messages(tmp_path / "real.bag")]
    assert recorded[0] == names.SESSION
    before_odometry = set(recorded[: recorded.index("/robot1/odom")])
    latched = {"/map", "/tf_static", "/thbridge_fleet/parameter_updates"}
    assert latched <= before_odometry, "they were sent before the yes, once"
