"""The study's parameters in a ground station's hands, in a whole session, and in its recording run again."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.parameters import RobotParameters, WorldParameters
from tests.support.hunts.recorded_hunts import assert_equal_replay
from tests.support.mavlink.recorded_stations import STUDY, Station, by_frames, record
from thbridge.app.compose.robots import build_team
from thbridge.app.compose.session import build_programs, open_session
from thbridge.app.compose.setting import read_setting
from thbridge.app.session.session import Session, SessionOutlets
from thbridge.mavlink.role.parameters import PARAMETERS
from thbridge.mavlink.wire.dialect import Message, decoded, mav
from thbridge.mavlink.wire.traffic import OutgoingFrame
from thbridge.recording.bag.reading.reader import messages
from thbridge.roles.shared.robot_requests import SetParameters
from thbridge.ros.messages import unpack

REAL32 = mav.MAV_PARAM_TYPE_REAL32


def setting_of(name: str, value: float, system: int = 1) -> Message:
    return mav.MAVLink_param_set_message(system, 1, name.encode(), value, REAL32)


class Played:
    """A session of two robots, and what their vehicles say on all links."""

    def __init__(self) -> None:
        setting = read_setting(STUDY, Path())
        self.team = build_team(setting)
        self._said: list[tuple[int, Message | None]] = []
        programs = build_programs(setting, team=self.team)
        self.session = open_session(setting, programs, outlets=SessionOutlets(transmit=self._take))
        self.station = Station(self.session)

    def _take(self, sent: Sequence[OutgoingFrame]) -> None:
        for each in sent:
            self._said.append((each.frame.system, decoded(each.frame.message_id, each.frame.payload)))

    def values(self) -> Iterator[tuple[int, str, float]]:
        """Values told since the last call: system, name, value."""
        said, self._said = self._said, []
        for system, message in said:
            if isinstance(message, mav.MAVLink_param_value_message):
                assert message.param_type == REAL32
                yield system, message.param_id, message.param_value

    def run(self, ticks: int) -> None:
        for _ in range(ticks):
            self.session.step()


@pytest.fixture
def played() -> Played:
    played = Played()
    played.run(2)
    return played


def test_a_list_has_all_parameters_of_the_study_as_they_are(played: Played) -> None:
    played.station.say(mav.MAVLink_param_request_list_message(2, 1))
    played.run(80)
    told = {name: value for system, name, value in played.values() if system == 2}
    assert {parameter.name for parameter in PARAMETERS} <= {*told}
    assert (told["AMCL_MAX_PART"], told["SIM_ODOM_LIN_SCL"]) == (1000.0, 1.0)
    assert told["SIM_LASER_NOISE"] == np.float32(0.02)


def test_what_is_set_is_in_force_with_the_next_tick_for_that_robot_alone(played: Played) -> None:
    played.station.say(setting_of("SIM_LASER_DROP", 0.1))
    played.station.say(setting_of("TP_MAX_VEL_X", 0.3))
    assert [*played.values()] == [(1, "SIM_LASER_DROP", np.float32(0.1)), (1, "TP_MAX_VEL_X", np.float32(0.3))]
    played.run(1)
    assert played.team.worlds[0].laser.dropout == 0.1
    assert played.team.parameters[0].TrajectoryPlannerROS.max_vel_x == 0.3
    assert (played.team.worlds[1], played.team.parameters[1]) == (WorldParameters(), RobotParameters())


def test_what_cannot_be_is_answered_with_the_old_value(played: Played) -> None:
    for value in (7.0, -1.0, float("nan")):
        played.station.say(setting_of("SIM_LASER_DROP", value))
        assert [*played.values()] == [(1, "SIM_LASER_DROP", np.float32(0.005))]
    played.run(2)
    assert played.team.worlds[0] == WorldParameters()


def test_what_a_researcher_changes_is_told_to_ground_stations_within_a_second(played: Played) -> None:
    played.station.beat()
    played.run(50)
    assert [*played.values()] == []
    played.session.ask("window", SetParameters(1, (("world.gyro_noise", 0.5), ("amcl.kld_err", 0.25))))
    played.run(52)
    assert {*played.values()} == {(2, "SIM_GYRO_NOISE", 0.5), (2, "AMCL_KLD_ERR", 0.25)}


def test_what_a_station_set_is_set_again_by_a_replay_whole_or_of_frames_alone(tmp_path: Path) -> None:
    stations: list[Station] = []

    def doing(tick: int, session: Session) -> None:
        if tick == 20:
            stations.append(Station(session))
        if tick >= 20 and tick % 50 == 20:
            stations[0].beat()
        if tick == 100:
            stations[0].say(setting_of("SIM_LASER_DROP", 1.0, 2))
            stations[0].say(setting_of("SIM_LASER_NOISE", 0.3))

    bag, again = tmp_path / "set.bag", tmp_path / "again.bag"
    record(bag, 150, doing, replace(STUDY, robots=2))
    assert_equal_replay(bag, 150)
    by_frames(bag, to=again)
    for scans in ([unpack.laser_scan(each.data) for each in messages(path, ["/robot2/scan"])] for path in (bag, again)):
        assert not np.isnan(scans[0].ranges).all()
        assert np.isnan(scans[-1].ranges).all()
