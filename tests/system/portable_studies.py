"""Plays short studies and prints digests of their messages: `python -m tests.system.portable_studies FOLDER NAME...`.

Bags of the studies come into the folder, which is made. Whatever the processor, the libraries or the interpreter are,
the digests must be the same. It needs no tool of tests, so that any interpreter with the program's own packages can run
it.
"""

import dataclasses
import json
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np

from sim.common.geometry import Pose2
from sim.common.observations import TICKS_PER_SECOND, Twist
from sim.inputs import (
    ClearCostmaps,
    DriveManually,
    GlobalLocalization,
    KidnapRobot,
    KillRobot,
    NomotionUpdate,
    PutThing,
    RemoveThing,
    ReviveRobot,
    SetPoseEstimate,
)
from sim.world.thing import Thing
from thbridge.app.compose.game import build_bot, build_hider, build_keeper
from thbridge.app.compose.recording import build_publisher, build_record, build_writer
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.setting import read_setting
from thbridge.app.compose.vehicles import vehicle_factory
from thbridge.app.play import PLAY
from thbridge.app.session.broadcast import Broadcast
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.session import Session
from thbridge.mavlink.wire.dialect import Message, crc_extra, mav, payload_of
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.outgoing import LinkId
from thbridge.recording.digest import digest_of
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.participant.tabui import TabUI
from thbridge.roles.shared.robot_requests import Request, SetParameters
from thbridge.ros.messages.records import CancelRequest, GoalRequest, InitialPose, SimpleGoal, VelocityCommand
from thbridge.study.study_file import read_study_text
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.router import ConnectionId

Inputs = Callable[[int, Session], None]
"""Gives a session what comes from outside before a tick."""


def nothing(tick: int, session: Session) -> None:
    """Give a session no input."""


_HERE = Pose2(1.0, 0.1 + 0.2, -0.0)
_CRATE = Thing("crate", ((0.1, 0.1), (-0.1, 0.1), (0.0, -0.1)), Pose2(3.0, 1.0, 0.0))
_ASKED: Mapping[int, Sequence[Request]] = {
    50: [DriveManually(0, Twist(0.3, 0.1), 40), SetPoseEstimate(1, _HERE, np.diag([0.1, 0.1, 0.2]))],
    120: [GlobalLocalization(0), NomotionUpdate(1), ClearCostmaps(1)],
    150: [PutThing(_CRATE), KillRobot(1)],
    200: [ReviveRobot(1), GoalRequest(1, "rviz-1", 4_000_000_000, Pose2(-2.0, 0.0, 1.0), 10**6)],
    230: [SimpleGoal(1, Pose2(2.0, 0.0, 1.0), 10**6 + 1), VelocityCommand(0, Twist(0.2, -0.4))],
    260: [CancelRequest(1, "", 0), InitialPose(0, _HERE, np.eye(3) / 7)],
    290: [SetParameters(0, (("amcl.max_particles", 333), ("amcl.laser_z_rand", 0.3)))],
    300: [RemoveThing("crate"), KidnapRobot(1, Pose2(0.0, 4.0, 1.0))],
}


def ros_clients(tick: int, session: Session) -> None:
    """Give a session what clients of ROS and researchers may ask."""
    for request in _ASKED.get(tick, ()):
        session.ask("/rviz", request)


class GroundStation:
    """Gives a session the frames of a ground station that drives both robots."""

    def __init__(self) -> None:
        self._sequence = 0
        self._link: LinkId | None = None

    def __call__(self, tick: int, session: Session) -> None:
        if tick == 10:
            self._link = session.links.open_link("udp 127.0.0.1:14550")
        if self._link is None:
            return
        if tick % 25 == 10:
            beat = mav.MAVLink_heartbeat_message(mav.MAV_TYPE_GCS, mav.MAV_AUTOPILOT_INVALID, 0, 0, 0, 3)
            self._say(session, beat)
        arm = mav.MAV_CMD_COMPONENT_ARM_DISARM
        local, go = mav.MAV_FRAME_LOCAL_NED, mav.MAV_CMD_DO_REPOSITION
        for robot in (1, 2):
            if tick == 20 + robot:
                self._say(session, mav.MAVLink_command_long_message(robot, 1, arm, 0, 1, 0, 0, 0, 0, 0, 0))
                self._say(session, mav.MAVLink_param_request_list_message(robot, 1))
            if tick == 60 * robot:
                place = (15_000 * robot, 20_000 - 30_000 * robot, 0.0)
                order = (robot, 1, local, go, 0, 0, -1.0, 1.0, 0.0, math.nan, *place)
                self._say(session, mav.MAVLink_command_int_message(*order))
        if 250 <= tick < 400 and tick % 5 == 0:
            stick = (0xDC7, 0, 0, 0, 0.3, 0, 0, 0, 0, 0, 0, 0.2)  # forwards, and turning
            self._say(session, mav.MAVLink_set_position_target_local_ned_message(0, 1, 1, 8, *stick))

    def _say(self, session: Session, message: Message) -> None:
        seed = crc_extra(message.get_msgId())
        assert seed is not None and self._link is not None
        frame = Frame(255, 190, self._sequence, message.get_msgId(), payload_of(message), seed)
        self._sequence = (self._sequence + 1) % 256
        session.transmit(session.links.receive_frame(self._link, frame).replies)


def clients(tick: int, session: Session) -> None:
    """Give a session lines of a program from outside."""
    if tick == 5:
        session.router.connect(0.3)
    if tick in {5, 150}:
        data = b"%%setid Noise extended a\n%%goto Noise SimR 0 5\r\n" if tick == 5 else b"%%where Noise SimR 0\n"
        session.perform(session.router.receive_data(ConnectionId(1), data, tick * 0.1))


@dataclasses.dataclass(frozen=True)
class PortableStudy:
    """A study and what comes into it.

    Attributes:
        text: the study file.
        seconds: simulated time.
        strategy: of the simulated participant; None: nobody plays.
        inputs: makes what gives further inputs.
    """

    text: str
    seconds: float
    strategy: BotStrategy | None = BotStrategy.NEAREST
    inputs: Callable[[], Inputs] = lambda: nothing


_DWA = "base_local_planner: dwa_local_planner/DWAPlannerROS"
_GLOBAL = "base_global_planner: global_planner/GlobalPlanner"
_THINGS = """\
things:
  - {name: door, shape: door, at: [7.0, -4.0, 1.5708], size: [2.0, 0.1]}
  - {name: crate, shape: crate, at: [3.0, 1.0, 0.5], appears: 2}
  - {name: visitor, shape: person, path: [[0, 2.0], [6, 2.0]], back_and_forth: true}
"""
_MISHAPS = """\
mishaps:
  - {robot: 2, what: dies, time: 4}
  - {robot: 2, what: revives, time: 8}
  - {robot: 3, what: carried, time: 6, to: [0, 4, 1]}
"""

STUDIES: Mapping[str, PortableStudy] = {
    "one robot": PortableStudy("robots: 1\nmap: practice\ntemplates: practice\n", 10.0),
    "two robots": PortableStudy("seed: 7\nrobots: 2\n", 8.0, BotStrategy.SUGGESTION),
    "kalman filter, dwa": PortableStudy(
        f"seed: 2\nrobots: 2\nrobot: {{localization: ekf, move_base: {{{_DWA}, {_GLOBAL}}}}}\n"
        "each: {2: {localization: ukf}}\n",
        8.0,
    ),
    "kalman filter, bad wheels": PortableStudy(
        "seed: 3\nrobots: 3\nmap: office\nnoise: {preset: bad wheels}\nrobot: {localization: ekf}\n"
        "each: {2: {localization: ukf}}\n",
        12.0,
    ),
    "the truth, dwa": PortableStudy(
        f"seed: 4\nrobots: 4\nrobot: {{localization: truth, move_base: {{{_DWA}}}}}\nmap: warehouse12\n", 15.0
    ),
    "beam model": PortableStudy(
        "seed: 5\nrobots: 2\nrobot: {amcl: {laser_model_type: beam, odom_model_type: diff-corrected}}\n", 12.0
    ),
    "likelihood field, prob": PortableStudy(
        "seed: 6\nrobots: 2\nnoise: {preset: turtlebot2}\n"
        "robot: {amcl: {laser_model_type: likelihood_field_prob, do_beamskip: true, odom_model_type: omni}}\n",
        12.0,
    ),
    "lost robots": PortableStudy(
        f"seed: 8\nrobots: 3\nmap: office\nrobot: {{amcl: {{recovery_alpha_slow: 0.001, recovery_alpha_fast: 0.1}}}}\n"
        f"{_MISHAPS.replace('[0, 4, 1]', '[0.2, 4.9, 0.0]')}",
        15.0,
        BotStrategy.RANDOM,
    ),
    "software of their own": PortableStudy(
        f"seed: 9\nrobots: 4\neach: {{2: {{localization: ekf}}, 3: {{move_base: {{{_DWA}, {_GLOBAL}}}}}, "
        "4: {localization: fake_localization}}\n",
        12.0,
    ),
    "things": PortableStudy(f"seed: 10\nrobots: 3\n{_THINGS}", 15.0),
    "things and mishaps": PortableStudy(
        f"seed: 11\nrobots: 3\nnoise: {{preset: turtlebot2}}\n{_THINGS}{_MISHAPS}", 12.0, BotStrategy.SUGGESTION
    ),
    "ten robots": PortableStudy("seed: 12\nrobots: 10\nmap: warehouse12\n", 20.0),
    "seven in the office": PortableStudy(f"seed: 13\nrobots: 7\nmap: office\nrobot: {{move_base: {{{_DWA}}}}}\n", 15.0),
    "argued": PortableStudy(
        "seed: 14\nrobots: 2\ndialogue: {condition: collaborator, manner: {misheard: 0.2, talkative: true}}\n", 6.0
    ),
    "adviser": PortableStudy(
        "seed: 15\nrobots: 3\nparticipant: {attitude: sceptical}\ntemplates: four-properties\n"
        "dialogue: {condition: adviser, planner: auction, adviser_error_rate: 0.3, says_confidence: true, "
        "confidence_spread: 0.2, language: de}\n",
        8.0,
    ),
    "autonomous": PortableStudy(
        "seed: 16\nrobots: 4\nmap: office\ntemplates: four-properties\nparticipant: {attitude: cautious}\n"
        "dialogue: {condition: autonomous, planner: tour, manner: {attitude: sceptical}, neglect: 2}\n",
        10.0,
        BotStrategy.SUGGESTION,
    ),
    "many to plan for": PortableStudy(
        "seed: 17\nrobots: 6\nmap: warehouse12\ngame: {cost_model: position}\ndialogue: {planner: joint}\n",
        6.0,
        BotStrategy.SUGGESTION,
    ),
    "clients of ros": PortableStudy("seed: 18\nrobots: 2\n", 8.0, inputs=lambda: ros_clients),
    "ground station": PortableStudy(
        "seed: 19\nrobots: 2\nmavlink: {on: true}\n", 10.0, strategy=None, inputs=GroundStation
    ),
    "client of 2016": PortableStudy("seed: 20\nrobots: 2\ntemplates: sklar-azhar-2015\n", 8.0, inputs=lambda: clients),
}
"""Studies by name: all localizers, planners, maps, dialogues and kinds of inputs."""


def play_study(name: str, bag: Path) -> None:
    """Play a study by name and record it."""
    chosen = STUDIES[name]
    setting = read_setting(read_study_text(Path(f"{name}.yaml"), chosen.text), Path())
    simr, study = build_simr(setting), setting.study
    player = None
    if chosen.strategy is not None:
        player = TabUI(build_bot(setting.templates, chosen.strategy, study.seed, study.participant.attitude))
    within = [legacy.SIMR, legacy.HIDER, *([] if player is None else [legacy.TABUI])]
    record = build_record(setting, PLAY, within, chosen.strategy or "")
    give = chosen.inputs()
    with build_writer(setting, bag) as writer:
        recorder = BagRecorder(Broadcast(build_publisher(setting), record, setting.map.grid, [writer]))
        roles = [simr, build_hider(setting.templates, study.seed)]
        vehicles = vehicle_factory(setting, simr) if study.mavlink.on else None
        session = Session(build_keeper(setting), roles, [recorder], () if player is None else (player,), vehicles)
        for tick in range(round(chosen.seconds * TICKS_PER_SECOND)):
            give(tick, session)
            session.step()


def bag_of(folder: Path, name: str) -> Path:
    """Path of the bag of a study."""
    return folder / f"{name.replace(' ', '_').replace(',', '')}.bag"


def main() -> None:
    """Play the studies that the command line names, or all."""
    folder, *names = sys.argv[1:]
    Path(folder).mkdir(parents=True)
    for name in names or STUDIES:
        bag = bag_of(Path(folder), name)
        play_study(name, bag)
        print(json.dumps({"name": name, "digest": digest_of(bag)}), flush=True)


if __name__ == "__main__":
    main()
