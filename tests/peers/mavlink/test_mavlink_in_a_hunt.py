"""Scripts that steer robots of a hunt: one of the manual's, and one that takes a robot from a participant."""

import json
import subprocess
from pathlib import Path

import pytest

from tests.peers.mavutil_script import Script, mav
from tests.peers.rover_session import PEERS, degrees, needs, rovers
from tests.support.programs.peer_programs import run_peer
from tests.support.programs.ports import free_udp_port
from tests.support.programs.processes import THBRIDGE, until


@pytest.mark.slow
def test_a_robot_is_taken_from_the_participant_and_given_back_and_the_hunt_comes_to_its_end(tmp_path: Path) -> None:
    port = free_udp_port()
    script = Script(f"udpin:127.0.0.1:{port}", 255)
    with rovers(tmp_path, (port,), "--identity", "ardupilot", participant="nearest") as play:
        assert script.master.wait_heartbeat(timeout=60) is not None
        script.follows(1)
        until("the first robot to be sent", lambda: "Robot 1 leaves for" in play.text, [play])
        script.arms()  # on its way: the participant loses it there
        script.master.set_mode("GUIDED")
        script.is_in("GUIDED")
        latitude, longitude = degrees(0.0, 1.2)
        goal = (-1, 1, 0, 0, round(latitude * 1e7), round(longitude * 1e7), 0)
        script.master.mav.command_int_send(1, 1, mav.MAV_FRAME_GLOBAL_INT, mav.MAV_CMD_DO_REPOSITION, 0, 0, *goal)
        assert script.result(mav.MAV_CMD_DO_REPOSITION) == mav.MAV_RESULT_ACCEPTED
        script.reaches(0.0, 1.2)
        script.master.arducopter_disarm()
        script.hears("HEARTBEAT", lambda told: not told.base_mode & mav.MAV_MODE_FLAG_SAFETY_ARMED)
        script.master.close()
        assert play.process.wait(300) == 0, play.text
    assert play.text.index("commanded by ground station 255") < play.text.index("commanded by the participant")
    for command in (["replay", "a.bag", "--json"], ["bag", "check", "a.bag"]):
        done = subprocess.run([*THBRIDGE, *command], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        if "--json" in command:
            assert json.loads(done.stdout)["equal"]


@pytest.mark.slow
def test_the_manuals_example_sends_a_robot_into_a_room(tmp_path: Path) -> None:
    port = free_udp_port()
    with rovers(tmp_path, (port,)) as play:
        names: dict[str, object] = {}
        exec(example_for("pymavlink", port), names)
        until("the robot to be sent", lambda: "Robot 1 leaves for room 2" in play.text, [play])
        names["station"].close()


@pytest.mark.parametrize(
    ("client", "identity", "robots"),
    [
        pytest.param("MAVSDK", "generic", "", marks=needs("mavsdk")),
        pytest.param("DroneKit", "ardupilot", "/1", marks=needs("dronekit")),
    ],
)
@pytest.mark.slow
def test_the_manuals_example_brings_a_robot_into_a_room(
    client: str, identity: str, robots: str, tmp_path: Path
) -> None:
    port = free_udp_port()
    latitude, longitude = degrees(-2.7, 1.4)  # here the map lies elsewhere than in the manual
    example = example_for(client, port).replace("51.5115126, -0.1160389", f"{latitude:.7f}, {longitude:.7f}")
    (tmp_path / "example.py").write_text(example)
    with rovers(tmp_path, (), "--udp", f"127.0.0.1:{port}{robots}", "--identity", identity) as play:
        command = [PEERS / client.lower() / "bin" / "python", "example.py"]
        done = run_peer(command, cwd=tmp_path, timeout=120)
        assert done.returncode == 0, done.stdout + done.stderr
        assert "Arrived." in done.stdout.splitlines()
        until("the robot to be there", lambda: "has reached room 2." in play.text, [play])


def example_for(client: str, port: int) -> str:
    """What the manual has a newcomer run."""
    manual = (Path(__file__).parents[3] / "docs" / "how-to" / "ground-stations.md").read_text()
    return manual.split(f"**{client}**")[1].split("```python\n")[1].split("```")[0].replace("14540", str(port))
