"""QGroundControl's way of meeting a vehicle, and what it does then, against a session's rovers; see qgroundcontrol.py.

The session runs in this process, and the ground station waits by its ticks: what took a second of silence would show.
"""

import json
import math
import random
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest

from sim.common.observations import TICKS_PER_SECOND
from tests.peers.mavlink.qgroundcontrol import COMPONENT, SYSTEM, Learned, QGroundControl, Step
from thbridge.app.compose.session import build_programs, open_session
from thbridge.app.compose.setting import read_setting
from thbridge.app.session.session import Session, SessionOutlets
from thbridge.mavlink.vehicle.component_files.metadata_files import checksum
from thbridge.mavlink.vehicle.vehicle import AutopilotIdentity
from thbridge.mavlink.wire.dialect import Message, crc_extra, decoded, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.mavlink.wire.traffic import OutgoingFrame
from thbridge.study.study_file import Study

ROBOT = 1
IDENTITIES = list(AutopilotIdentity)

HOLD, AUTO, GUIDED = 4, 10, 15
"""ArduPilot's numbers."""


def sitting(identity: AutopilotIdentity, transmit: Callable[[Sequence[OutgoingFrame]], None]) -> Session:
    """Two robots that know where they are, as vehicles, and the game; nobody plays."""
    study = Study()
    study = replace(
        study,
        robot=replace(study.robot, localization="truth"),
        mavlink=replace(study.mavlink, on=True, identity=identity),
    )
    setting = read_setting(study, Path())
    session = open_session(setting, build_programs(setting), outlets=SessionOutlets(transmit=transmit))
    for _ in range(2 * TICKS_PER_SECOND):
        session.step()
    return session


@dataclass
class Loopback:
    """A link into a session in this process; `loss` is the share of frames that get lost, either way."""

    identity: AutopilotIdentity
    loss: float = 0.0
    chance: random.Random = field(default_factory=lambda: random.Random(1))
    came: deque[Message] = field(default_factory=deque)
    sequence: int = 0
    robot: int = ROBOT

    def __post_init__(self) -> None:
        self.number: LinkId | None = None
        self.session = sitting(self.identity, self._take)
        self.number = self.session.links.open_link("loopback")

    def send(self, message: Message) -> None:
        self.sequence = (self.sequence + 1) % 256
        if self.chance.random() >= self.loss:
            seed = crc_extra(message.get_msgId())
            assert seed is not None
            frame = Frame(SYSTEM, COMPONENT, self.sequence, message.get_msgId(), payload_of(message), seed)
            self._take(self.session.links.receive_frame(self.number, frame).replies)

    def receive(self, seconds: float) -> Message | None:
        end = self.now() + seconds
        while not self.came:
            if self.now() >= end:
                return None
            if self.session.tick % TICKS_PER_SECOND == 0:
                self.send(mav.MAVLink_heartbeat_message(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 0, 3))
            self.session.step()
        return self.came.popleft()

    def now(self) -> float:
        return self.session.tick / TICKS_PER_SECOND

    def _take(self, sent: Sequence[OutgoingFrame]) -> None:
        for word in sent:
            if word.link == self.number and word.frame.system == self.robot and self.chance.random() >= self.loss:
                message = decoded(word.frame.message_id, word.frame.payload)
                assert message is not None
                self.came.append(message)


def connected(
    identity: AutopilotIdentity, *, modes_at_once: bool = False, loss: float = 0.0
) -> tuple[QGroundControl, Learned]:
    link = Loopback(identity, loss)
    station = QGroundControl(
        link, ROBOT, ardupilot=identity is AutopilotIdentity.ARDUPILOT, modes_at_once=modes_at_once
    )
    return station, station.connect()


@pytest.mark.parametrize("modes_at_once", [False, True])
@pytest.mark.parametrize("identity", IDENTITIES)
def test_every_step_of_connecting_is_answered_at_once(identity: AutopilotIdentity, modes_at_once: bool) -> None:
    station, learned = connected(identity, modes_at_once=modes_at_once)
    assert [step for step in learned.steps if step.asked != 1 or "silence" in step.answer] == []
    assert [step for step in learned.steps if "nothing" in step.answer or "not come" in step.answer] == []
    assert {step.name for step in learned.steps} >= {
        "request AUTOPILOT_VERSION", "request AVAILABLE_MODES", "request COMPONENT_METADATA",
        "parameter list", "plan 0",
    }  # fmt: skip
    assert station.link.now() < 10.0  # of which two seconds had gone before


@pytest.mark.parametrize("identity", IDENTITIES)
def test_it_learns_modes_parameters_and_plans(identity: AutopilotIdentity) -> None:
    station, learned = connected(identity)
    assert station.mode in learned.modes  # the heartbeat's has a name
    assert len(set(learned.modes.values())) == len(learned.modes)
    assert learned.parameters["SIM_ODOM_ALPHA1"] == pytest.approx(0.02)
    assert learned.capabilities & mav.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    assert learned.capabilities & mav.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    assert all(len(items) <= 1 for items in learned.items.values())  # there is no plan but, maybe, home


@pytest.mark.parametrize("identity", IDENTITIES)
def test_it_learns_what_every_parameter_means(identity: AutopilotIdentity) -> None:
    station, learned = connected(identity)
    assert learned.capabilities & mav.MAV_PROTOCOL_CAPABILITY_FTP
    assert set(learned.meanings) == set(learned.parameters)
    limit = learned.meanings["TP_MAX_VEL_X"]
    assert (limit["units"], limit["group"], limit["type"]) == ("m/s", "base_local_planner", "Float")
    assert limit["default"] == pytest.approx(learned.parameters["TP_MAX_VEL_X"])
    told = station.request(397)
    assert told is not None
    assert told.file_crc == checksum(learned.files[told.uri])
    (about,) = json.loads(learned.files[told.uri])["metadataTypes"]
    assert about["fileCrc"] == checksum(learned.files[about["uri"]])


def test_robots_with_the_same_parameters_have_files_that_are_kept_but_once() -> None:
    kept = set()
    for robot in (1, 2):
        told = QGroundControl(Loopback(AutopilotIdentity.GENERIC, robot=robot), robot, ardupilot=False).request(397)
        assert told is not None
        kept.add((told.uri, told.file_crc))
    assert len(kept) == 1


def test_over_a_bad_link_files_arrive_whole_or_not_at_all() -> None:
    """It opens a file once, so that of ten tries on a link that loses a tenth each way some fail."""
    _, learned = connected(AutopilotIdentity.GENERIC)
    for seed in range(10):
        station = QGroundControl(Loopback(AutopilotIdentity.GENERIC, 0.1, random.Random(seed)), ROBOT, ardupilot=False)
        station.asks_for_metadata()
        assert station.learned.files.items() <= learned.files.items()
        if station.learned.files == learned.files:
            assert station.learned.meanings == learned.meanings
            return
    pytest.fail("no try succeeded")


@pytest.mark.parametrize("kind", [mav.MAV_MISSION_TYPE_FENCE, mav.MAV_MISSION_TYPE_RALLY])
@pytest.mark.parametrize("identity", IDENTITIES)
def test_fence_and_rally_are_empty_for_a_station_that_missed_that_there_are_none(
    identity: AutopilotIdentity, kind: int
) -> None:
    station, learned = connected(identity)
    assert kind not in learned.items
    station.reads_plan(kind)
    assert learned.steps[-1] == Step(f"plan {kind}", 1, "0 items")


@pytest.mark.parametrize("identity", IDENTITIES)
def test_it_connects_though_a_third_of_all_frames_are_lost(identity: AutopilotIdentity) -> None:
    _, learned = connected(identity, loss=0.3)
    got, count = next(step.answer for step in learned.steps if step.name == "parameters").split(" of ")
    assert int(got) > 0.9 * int(count)  # it gives each five tries
    assert mav.MAV_MISSION_TYPE_MISSION in learned.items
    assert learned.files.items() <= connected(identity)[1].files.items()  # what came came whole


def waypoint(seq: int, x: int, y: int) -> Message:
    frame = mav.MAV_FRAME_GLOBAL_RELATIVE_ALT if seq else mav.MAV_FRAME_GLOBAL
    params = (0.0, 0.0, 0.0, math.nan, x, y, 0.0)
    return mav.MAVLink_mission_item_int_message(
        ROBOT, 1, seq, frame, mav.MAV_CMD_NAV_WAYPOINT, int(seq == 0), 1, *params
    )


def test_a_plan_with_home_before_it_is_written_and_read_back_and_driven() -> None:
    station, _ = connected(AutopilotIdentity.ARDUPILOT)
    position = station.wait(3.0, "GLOBAL_POSITION_INT")
    assert position is not None
    north = 100  # of 1e-7 degrees: a meter and a bit
    places = [(position.lat, position.lon), (position.lat + north, position.lon), (position.lat, position.lon + north)]
    items = [waypoint(seq, *place) for seq, place in enumerate(places)]
    assert station.writes_plan(items) == str(mav.MAV_MISSION_ACCEPTED)
    station.reads_plan(mav.MAV_MISSION_TYPE_MISSION)
    back = station.learned.items[mav.MAV_MISSION_TYPE_MISSION]
    assert [(item.x, item.y) for item in back[1:]] == places[1:]
    assert station.changes_mode(GUIDED)
    assert station.arms()
    assert station.command("start", mav.MAV_CMD_MISSION_START) == mav.MAV_RESULT_ACCEPTED
    assert station.sees(1.3, lambda: station.mode == AUTO)
    assert station.wait(60.0, "MISSION_ITEM_REACHED", lambda told: told.seq == len(items) - 1) is not None


def test_go_to_is_offered_once_it_is_armed_and_may_be_redirected_on_the_way() -> None:
    station, _ = connected(AutopilotIdentity.ARDUPILOT)
    assert not station.flying
    assert station.arms()
    assert station.flying  # or else there is no go-to on the map
    position = station.wait(3.0, "GLOBAL_POSITION_INT")
    assert position is not None
    latitude, longitude, altitude = position.lat / 1e7, position.lon / 1e7, position.alt / 1e3
    assert station.goes_to(latitude + 2e-5, longitude, altitude) == mav.MAV_RESULT_ACCEPTED
    assert station.sees(1.3, lambda: station.mode == GUIDED)
    moving = station.wait(10.0, "GLOBAL_POSITION_INT", lambda told: told.vx > 10)
    assert moving is not None
    assert station.goes_to(latitude, longitude, altitude) == mav.MAV_RESULT_ACCEPTED
    back = station.wait(20.0, "GLOBAL_POSITION_INT", lambda told: abs(told.lat - position.lat) < 30 and told.vx == 0)
    assert back is not None
    assert station.changes_mode(HOLD)
