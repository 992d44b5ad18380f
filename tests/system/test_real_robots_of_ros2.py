"""From simulation to Nav2 robots: one process has robots on a ROS 2 graph, the game commands them there."""

import json
from pathlib import Path

import pytest

from tests.support.programs.ports import free_domain, free_port
from tests.support.programs.processes import Program, journal, kinds, port_of, until
from thbridge.recording.bag.reading import reader as bag_reader
from thbridge.ros import names
from thbridge.ros.messages import types, unpack

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("carrier", ["dds", "zenoh"])
def test_a_whole_hunt_with_nav2_robots_of_another_process(carrier: str, tmp_path: Path) -> None:
    bag, domain = tmp_path / "real.bag", free_domain()
    section = f"domain: {domain}, use_sim_time: true"
    programs: list[Program] = []
    try:
        if carrier == "zenoh":
            programs.append(Program(tmp_path, "ros2", "router", "--listen", f"127.0.0.1:{free_port()}"))
            section += f", carrier: zenoh, router: '127.0.0.1:{port_of(programs[0], programs)}'"
        (tmp_path / "study.yaml").write_text(f"robots_from: ros2\nrobots: 2\nros2: {{{section}}}\n")
        simulated = ("--robots-from", "sim", "--ros2", "--rate", "3", "--server", "127.0.0.1:9")
        field, server = Program(tmp_path, "simr", "study.yaml", *simulated), Program(tmp_path, "server", "--port", "0")
        programs += [field, server]
        at = f"127.0.0.1:{port_of(server, programs)}"
        until("the robots to be on the graph", lambda: f"ROS 2: Jazzy in domain {domain}" in field.text, programs)
        simr = Program(tmp_path, "simr", "--study", "study.yaml", "--server", at, "--bag", str(bag))
        programs.append(simr)
        until("all robots to be found", lambda: "All robots have been found" in simr.text, programs)
        programs.append(Program(tmp_path, "hider", "--server", at))
        player = Program(tmp_path, "tabui", "--server", at, "--json")
        programs.append(player)
        until("the game to be over", lambda: player.process.poll() is not None, programs, 280.0)
        assert json.loads(player.text.splitlines()[-1])["rooms_visited"] == 8
        assert "reported" not in kinds(tmp_path)
        assert simr.stop() == 0
        replay = Program(tmp_path, "replay", str(bag))
        programs.append(replay)
        assert replay.process.wait(60) == 2
        assert "its robots were real" in replay.text
    finally:
        for program in programs:
            program.close()
    recorded = {topic.name: topic for topic in bag_reader.info(bag).topics}
    assert recorded["/robot1/odom"].messages > 1000
    assert names.CLOCK not in recorded
    arrived = [event for event in journal(tmp_path) if event["event"] == "arrived"]
    results = [f"/robot{number}/navigate_to_pose/result" for number in (1, 2)]
    ends = list(bag_reader.messages(bag, results))
    assert len(arrived) == 8
    assert [unpack.move_base_result(end.data).status for end in ends] == [3] * 8
    first = next(bag_reader.messages(bag))
    assert (first.topic, first.msgtype) == (names.SESSION, types.SESSION)
    assert "robots_from: ros2" in unpack.session(first.data).study
