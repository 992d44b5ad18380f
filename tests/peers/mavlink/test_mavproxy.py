"""MAVProxy: modes, arming, guided, missions, parameters.

It has several hundred commands; what is done here is what the manual of its rover begins with.
"""

from collections.abc import Iterator

import pytest

from tests.peers.mavlink.mavproxy import MavProxy
from tests.peers.rover_session import degrees, needs, rovers
from tests.support.programs.ports import free_udp_port
from tests.support.programs.processes import until

pytestmark = [needs("mavproxy"), pytest.mark.slow]

PARAMETER = "SIM_ODOM_ALPHA1"


@pytest.fixture(scope="module")
def proxy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[MavProxy]:
    folder, port = tmp_path_factory.mktemp("mavproxy"), free_udp_port()
    with rovers(folder, (port,), "--identity", "ardupilot"), MavProxy(folder / "mavproxy", port) as proxy:
        proxy.says(r"Received \d+ parameters")
        yield proxy


def test_all_robots_are_detected(proxy: MavProxy) -> None:
    detected = [f"Detected vehicle {system}:1 on link 0" for system in (1, 2, 3)]
    until("every robot to be detected", lambda: all(line in proxy.output.read_text() for line in detected), [])


def test_a_parameter_is_shown_set_and_a_wrong_one_refused(proxy: MavProxy) -> None:
    before = float(proxy.does(f"param show {PARAMETER}", rf"{PARAMETER}\s+([\d.]+)")[1])
    proxy.types(f"param set {PARAMETER} {before + 0.25}")
    proxy.says(rf"{PARAMETER} = {before + 0.25:.4f}", again=f"param fetch {PARAMETER}")
    kept = rf"Failed to set {PARAMETER} to -7 \(invalid returned value {before + 0.25:.2f}"
    proxy.does(f"param set {PARAMETER} -7", kept)


def test_it_is_armed_guided_to_a_point_and_held(proxy: MavProxy) -> None:
    proxy.does("arm throttle", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED")
    proxy.says("ARMED")
    proxy.does("mode GUIDED", "Mode GUIDED")
    latitude, longitude = degrees(0.0, 1.2)
    proxy.does(f"guided {latitude:.7f} {longitude:.7f} 0", "Got COMMAND_ACK: DO_REPOSITION: ACCEPTED")
    proxy.says(r"x : 1\.\d+, y : -?0\.\d+, z", again="status LOCAL_POSITION_NED")  # the others are elsewhere
    proxy.does("mode HOLD", "Mode HOLD")
    proxy.does("disarm", "DISARMED")


def test_home_is_set_to_a_place(proxy: MavProxy) -> None:
    north, east = (round(degree * 1e7) for degree in degrees(0.0, 0.6))
    line = f"command_int GLOBAL_RELATIVE_ALT DO_SET_HOME 0 0 0 0 0 0 {north} {east} 0"
    proxy.does(line, "Got COMMAND_ACK: DO_SET_HOME: ACCEPTED")
    proxy.says(rf"HOME_POSITION {{latitude : {north},", again="status HOME_POSITION")


def test_a_mission_is_loaded_listed_run_and_cleared(proxy: MavProxy) -> None:
    places = [degrees(0.0, 0.0), degrees(0.0, 0.6), degrees(0.3, 0.3)]
    lines = [
        f"{seq}\t{int(seq == 0)}\t{3 if seq else 0}\t16\t0\t0\t0\t0\t{place[0]:.8f}\t{place[1]:.8f}\t0\t1"
        for seq, place in enumerate(places)
    ]
    plan = proxy.folder / "plan.txt"
    plan.write_text("\n".join(["QGC WPL 110", *lines]) + "\n")
    proxy.does(f"wp load {plan}", "Got MISSION_ACK: TYPE_MISSION: ACCEPTED")
    proxy.does("wp list", "Requesting 3 waypoints")
    for place in places[1:]:
        found = proxy.says(r"16 3 (-?[\d.]+) (-?[\d.]+) ")
        assert (float(found[1]), float(found[2])) == pytest.approx(place, abs=2e-7)
    proxy.does("arm throttle", "ARMED")
    proxy.does("mode AUTO", "AUTO> ")
    proxy.says("waypoint 2")
    proxy.says("Mission complete")
    proxy.says("HOLD> ")
    proxy.does("wp clear", "Got MISSION_ACK: TYPE_MISSION: ACCEPTED")
    proxy.does("wp list", "Requesting 0 waypoints")
    proxy.does("disarm", "DISARMED")


def test_another_robot_is_chosen(proxy: MavProxy) -> None:
    proxy.does("vehicle 3", "Set vehicle 3")
    proxy.does("arm throttle", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED")
    proxy.does("disarm", "Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED")
    proxy.does("vehicle 1", "Set vehicle 1")
