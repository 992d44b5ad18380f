"""Places that a robot of a hunt cannot go to, and those where it has been, for a script with pymavlink's `mavutil`."""

import math
from pathlib import Path

import pytest

from tests.peers.mavutil_script import PATIENCE, Script, mav
from tests.peers.rover_session import degrees, rovers
from tests.support.programs.ports import free_udp_port
from tests.support.programs.processes import until
from thbridge.app.compose.setting import read_setting
from thbridge.study.study_file import Study

pytestmark = pytest.mark.slow


def _place(east: float, north: float) -> tuple[int, int]:
    latitude, longitude = degrees(east, north)
    return round(latitude * 1e7), round(longitude * 1e7)


def _sends(script: Script, *places: tuple[float, float]) -> int:
    """Send a mission; the answer."""
    script.master.mav.mission_count_send(1, 1, len(places), mav.MAV_MISSION_TYPE_MISSION)
    while (told := script.hears("MISSION_REQUEST_INT|MISSION_ACK")).get_type() == "MISSION_REQUEST_INT":
        where = (0, 0, 0, math.nan, *_place(*places[told.seq]), 0)
        waypoint = (told.seq, mav.MAV_FRAME_GLOBAL_INT, mav.MAV_CMD_NAV_WAYPOINT, 0, 1, *where)
        script.master.mav.mission_item_int_send(1, 1, *waypoint)
    return int(told.type)


def test_places_off_the_map_are_denied_and_visited_rooms_skipped(tmp_path: Path) -> None:
    rooms = read_setting(Study(), Path()).map.rooms
    second, fourth = ((room.goal.x, room.goal.y) for room in (rooms[1], rooms[3]))
    port = free_udp_port()
    script = Script(f"udpin:127.0.0.1:{port}", 255)
    with rovers(tmp_path, (port,), section="  visited_rooms: skip\n") as play:
        until("the robots to be reached", lambda: "MAVLink links of the robots" in play.text, [play])
        script.beat()
        assert script.master.wait_heartbeat(timeout=PATIENCE) is not None
        script.follows(1)
        script.hears("HEARTBEAT")
        script.arms()
        for place, said in (((200.0, 0.0), "stand is not on"), ((0.975, 3.925), "should stand, the map has")):
            goal = (-1.0, 1.0, 0.0, math.nan, *_place(*place), 0.0)
            script.master.mav.command_int_send(1, 1, mav.MAV_FRAME_GLOBAL_INT, mav.MAV_CMD_DO_REPOSITION, 0, 0, *goal)
            assert script.result(mav.MAV_CMD_DO_REPOSITION) == mav.MAV_RESULT_DENIED
            script.hears("STATUSTEXT", lambda told, said=said: said in told.text)
        assert _sends(script, second, (0.0, 200.0)) == mav.MAV_MISSION_INVALID_PARAM5_X
        script.hears("STATUSTEXT", lambda told: "in item 1" in told.text)
        assert _sends(script, second, (200.0, 0.0)) == mav.MAV_MISSION_INVALID_PARAM6_Y
        assert _sends(script, second, fourth, second, fourth) == mav.MAV_MISSION_ACCEPTED
        assert script.commands(mav.MAV_CMD_MISSION_START) == mav.MAV_RESULT_ACCEPTED
        script.hears("STATUSTEXT", lambda told: "Mission item 2 skipped. Room 2 has been" in told.text)
        script.hears("MISSION_ITEM_REACHED", lambda told: told.seq == 3)
        script.hears("STATUSTEXT", lambda told: "Mission complete" in told.text)
    script.master.close()
