import asyncio
import dataclasses
import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from sim.common.geometry import Pose2
from sim.common.observations import Twist
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
    SetWorldParameters,
)
from sim.parameters import WorldParameters
from sim.world.thing import Thing
from tests.support.hunts.recorded_hunts import STUDY, assert_equal_replay, bot_of, record, replay_again, setting_of
from thbridge.app.compose.game import build_hider, build_keeper
from thbridge.app.compose.recording import build_publisher, build_record, build_recorder, build_writer
from thbridge.app.compose.robots import build_simr
from thbridge.app.compose.session import SessionRecording, build_programs, open_session
from thbridge.app.listeners import StartupCallbacks, WatchAddress
from thbridge.app.play import PLAY, HuntUnfinished, PlayOptions, play
from thbridge.app.programs import SIMR
from thbridge.app.replay.replay import NOT_IN_OLDER, ReplayOptions, recorded_study, replay, session_of, ticks_of
from thbridge.app.session.broadcast import Broadcast
from thbridge.app.session.inputs import (
    BytesReceived,
    ClientRequest,
    ClockAdvanced,
    ConnectionBacklogged,
    ConnectionClosed,
    ConnectionOpened,
    Input,
    ParticipantSent,
)
from thbridge.app.session.recording import BagRecorder
from thbridge.app.session.session import NO_OUTLETS, Session, SessionOutlets, TickRecord
from thbridge.app.session.simr_session import SimrSession
from thbridge.app.session.watch_requests import request_line
from thbridge.files.errors import BadFile
from thbridge.hunt.team_planner import TeamPlanner
from thbridge.recording.bag.options import Compression, RecordingDetail
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.repair import reindex
from thbridge.recording.bag.writing.writer import BagWriter
from thbridge.roles.participant.bot_strategy import BotStrategy
from thbridge.roles.shared.notices import KEEPER, MoveOrder, Orders, Subscribe
from thbridge.roles.shared.robot_requests import (
    PaceRequest,
    Pause,
    Request,
    Resume,
    SetParameters,
    Step,
    WizardAdvice,
    WizardMode,
    WizardMove,
)
from thbridge.ros import names
from thbridge.ros.messages import pack, unpack
from thbridge.ros.messages.records import CancelRequest, GoalRequest, InitialPose, SimpleGoal, VelocityCommand
from thbridge.ros.messages.stamps import START_NS, TICK_NS
from thbridge.ros.publisher import RosMessage, Topic
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.study.overrides import StudyChange
from thbridge.study.study_file import DialogueSection, RecordingSection, Study, read_study_text
from thbridge.text_protocol.sockets.client import TextClient
from thbridge.text_protocol.wire import legacy
from thbridge.text_protocol.wire.client import NameRegistered
from thbridge.text_protocol.wire.lines import TextMessage
from thbridge.text_protocol.wire.notice_format import encode_notice
from thbridge.text_protocol.wire.router import ConnectionId, RouterOutput, SendToClient
from thbridge.watching import wire
from thbridge.watching.sockets.client import WatchClient


def watched(bag: Path, study: Study, seconds: float, plan: Sequence[tuple[int, Request | PaceRequest]]) -> list[type]:
    """A hunt as `record` makes it, with a researcher who asks for something whenever so many ticks have passed; what
    was recorded of that."""
    setting, waiting, clients = setting_of(study), list(plan), list[WatchClient]()
    running: list[asyncio.Task[None]] = []

    def come(where: ListeningAddress | CannotListen) -> None:
        assert isinstance(where, ListeningAddress)
        clients.append(WatchClient(where.host, where.port))
        running.extend((asyncio.ensure_future(clients[0].run()), asyncio.ensure_future(look())))

    async def look() -> None:
        tick = 0
        while waiting:
            for event in clients[0].take():
                if isinstance(event, wire.SessionMessage) and event.topic == names.TF:
                    tick = (event.stamp_ns - START_NS) // TICK_NS
            while waiting and tick >= waiting[0][0]:
                assert clients[0].send(request_line("researcher", waiting.pop(0)[1]))
            await asyncio.sleep(0)

    async def whole() -> None:
        options = PlayOptions(20.0, bag, frozenset(), "suggestion", seconds, watch=WatchAddress("127.0.0.1", 0, None))
        told = StartupCallbacks(lambda master: None, come)
        try:
            await play(setting, (bot_of(setting),), options, lambda where: None, lambda tick_record: None, told)
        finally:
            for task in running:
                task.cancel()

    with pytest.raises(HuntUnfinished):
        asyncio.run(whole())
    assert not waiting
    return [
        type(item.request) for item in inputs(bag) if isinstance(item, ClientRequest) and item.sender == "researcher"
    ]


def act(
    bag: Path,
    study: Study,
    ticks: int,
    doing: Callable[[int, Session], None],
    outlets: SessionOutlets = NO_OUTLETS,
) -> None:
    """A hunt with a simulated participant, and something that is done from outside before each tick."""
    setting = setting_of(study)
    programs = build_programs(setting, (bot_of(setting),))
    opening = build_record(setting, PLAY, programs.names, "suggestion")
    with build_writer(setting, bag) as writer:
        recording = SessionRecording([build_recorder(setting, opening, [writer])])
        session = open_session(setting, programs, recording, outlets)
        for tick in range(ticks):
            doing(tick, session)
            session.step()


def subscription(name: str) -> bytes:
    return (encode_notice(name, legacy.SIMR, Subscribe()).line() + "\n").encode()


def inputs(bag: Path) -> Iterator[Input]:
    for tick in ticks_of(bag):
        yield from tick.inputs


@pytest.fixture(scope="module")
def hunt(tmp_path_factory: pytest.TempPathFactory) -> Path:
    bag = tmp_path_factory.mktemp("hunt") / "hunt.bag"
    record(bag, STUDY, 16.0)
    return bag


class TestSame:
    def test_a_hunt_is_the_same_again_to_the_last_bit(self, hunt: Path, tmp_path: Path) -> None:
        assert_equal_replay(hunt, 16 * 50)
        replay_again(hunt, to=tmp_path / "again.bag")
        assert list(messages(tmp_path / "again.bag")) == list(messages(hunt))

    def test_a_recording_of_before_rooms_had_names_and_robots_said_to_make_way_is_the_same_again(
        self, hunt: Path, tmp_path: Path
    ) -> None:
        whole = list(messages(hunt))
        line = next(message for message in whole if message.topic == names.ROSOUT)
        with BagWriter(tmp_path / "older.bag") as writer:
            for message in whole:
                if message.topic != names.ROOMS and message is not line:
                    topic = Topic(message.topic, message.msgtype)
                    writer.write(RosMessage(topic, message.stamp_ns, message.data))
        done = replay_again(tmp_path / "older.bag")
        assert (done.difference, done.cut_off, done.ticks) == (None, False, 16 * 50)
        assert done.messages == sum(message.topic not in NOT_IN_OLDER | {names.SESSION} for message in whole)

    def test_a_recording_of_before_robots_knew_how_likely_they_are_wrong_is_the_same_again(
        self, hunt: Path, tmp_path: Path
    ) -> None:
        whole = list(messages(hunt))
        known = [message for message in whole if message.topic.endswith("/p_wrong")]
        assert {message.topic for message in known} == {"/robot1/p_wrong", "/robot2/p_wrong"}
        with BagWriter(tmp_path / "older.bag") as writer:
            for message in whole:
                if message not in known:
                    writer.write(RosMessage(Topic(message.topic, message.msgtype), message.stamp_ns, message.data))
        done = replay_again(tmp_path / "older.bag")
        assert (done.difference, done.cut_off, done.ticks) == (None, False, 16 * 50)

    def test_a_recording_of_before_advice_was_recorded_is_the_same_again(self, hunt: Path, tmp_path: Path) -> None:
        first, *rest = messages(hunt)
        opening = unpack.session(first.data)
        older = dataclasses.replace(opening, study=opening.study.replace("  planner: joint\n", ""))
        assert older != opening
        with BagWriter(tmp_path / "older.bag") as writer:
            writer.write(RosMessage(Topic(first.topic, first.msgtype), first.stamp_ns, pack.session(0, older)))
            for message in rest:
                if message.topic != names.GAME_EVENTS or unpack.game_event(message.data).kind != "advised":
                    writer.write(RosMessage(Topic(message.topic, message.msgtype), message.stamp_ns, message.data))
        done = replay_again(tmp_path / "older.bag")
        assert (done.difference, done.ticks) == (None, 16 * 50)
        assert done.messages < len(rest)

    def test_advice_errs_again_where_it_did(self, tmp_path: Path) -> None:
        talk = DialogueSection(
            planner=TeamPlanner.AUCTION, adviser_error_rate=0.5, says_confidence=True, confidence_spread=0.1
        )
        record(tmp_path / "erring.bag", dataclasses.replace(STUDY, dialogue=talk), 20.0)
        assert_equal_replay(tmp_path / "erring.bag", 20 * 50)
        told = [unpack.game_event(message.data) for message in messages(tmp_path / "erring.bag", [names.GAME_EVENTS])]
        advice = [json.loads(event.json) for event in told if event.kind == "advised"]
        assert len(advice) > 1
        assert all((each["planned"] != each["room"]) == each["erred"] for each in advice)
        assert all(0.4 <= each["confidence"] <= 0.6 for each in advice)
        assert len({each["confidence"] for each in advice}) > 1

    def test_what_a_researcher_did_at_the_watch_door_is_done_again(self, tmp_path: Path) -> None:
        crate = Thing("crate", ((0.3, 0.3), (-0.3, 0.3), (-0.3, -0.3), (0.3, -0.3)), Pose2(0.0, 0.5, 0.2))
        plan: list[tuple[int, Request | PaceRequest]] = [
            (40, Pause()),
            (40, SetParameters(0, (("amcl.recovery_alpha_fast", 0.1),))),
            (40, KidnapRobot(0, Pose2(1.0, 0.0, 0.0))),
            (40, Step(30)),
            (60, PutThing(crate)),
            (70, Resume()),
            (120, KillRobot(1)),
            (180, ReviveRobot(1)),
            (190, SimpleGoal(1, Pose2(2.0, 0.0, 0.0), 0)),
        ]
        bag = tmp_path / "hunt.bag"
        asked = watched(bag, STUDY, 8.0, plan)
        assert asked == [type(request) for _, request in plan if not isinstance(request, Pause | Resume | Step)]
        assert_equal_replay(bag, 8 * 50)

    def test_sensors_that_get_worse_midway_do_so_again(self, tmp_path: Path) -> None:
        worse = (("world.laser.range_noise", 0.4), ("world.odometry.angular_scale", 1.3), ("amcl.laser_sigma_hit", 0.4))

        def disturb(tick: int, session: Session) -> None:
            if tick == 80:
                session.ask("window", SetParameters(0, worse))
            if tick == 120:
                session.ask("window", SetParameters(1, (("world.laser.dropout", 1.0),)))
            if tick == 160:
                session.ask("window", SetWorldParameters(1, WorldParameters()))

        act(tmp_path / "plain.bag", STUDY, 200, lambda tick, session: None)
        act(tmp_path / "worse.bag", STUDY, 200, disturb)
        assert_equal_replay(tmp_path / "worse.bag", 200)
        scans = [names.RobotNames.of(robot).topic("scan") for robot in range(2)]
        plain, worse_ones = (
            [[message.data for message in messages(tmp_path / name, [scan])] for scan in scans]
            for name in ("plain.bag", "worse.bag")
        )
        assert plain[0][:15] == worse_ones[0][:15]
        assert all(before != after for before, after in zip(plain[0][17:], worse_ones[0][17:], strict=True))
        assert plain[1] != worse_ones[1]

    def test_what_a_wizard_said_is_said_again(self, tmp_path: Path) -> None:
        def conjure(tick: int, session: Session) -> None:
            if tick == 1:
                session.ask("wizard", WizardMode(0, on=True))
            if tick == 60:
                session.ask("wizard", WizardAdvice(0, 5))
                session.ask("wizard", WizardMove(1, 0, 0, "This is for a later turn, or none."))
            if tick == 80:
                session.ask("wizard", WizardMode(0, on=False))
            for number in (1, 2):
                if tick == 70:
                    session.ask("wizard", WizardMove(number, 0, 0, "Room 5, shall I?"))

        bag = tmp_path / "hunt.bag"
        act(bag, STUDY, 200, conjure)
        assert_equal_replay(bag, 200)
        said = [unpack.utterance(message.data) for message in messages(bag, [names.UTTERANCES])]
        ours = [(said.author, said.text) for said in said if said.robot == 0 and said.author != "person"]
        assert ours[0] == ("wizard", "Room 5, shall I?")
        assert {author for author, _ in ours[1:]} == {"robot"}
        held = [json.loads(unpack.string(message.data)) for message in messages(bag, [names.WIZARD])]
        assert held[0]["puppets"] == [0]
        assert held[-1] == {"puppets": [], "turns": [], "advice": []}
        assert any(level["advice"] for level in held)
        assert any(level["turns"] for level in held)

    def test_packed_and_split_recordings_are_read_as_one(self, tmp_path: Path) -> None:
        bag = tmp_path / "hunt.bag"
        recording = RecordingSection(Compression.LZ4, split_duration=2.0)
        record(bag, dataclasses.replace(STUDY, recording=recording), 5.0)
        assert (tmp_path / "hunt_1.bag").exists()
        assert_equal_replay(bag, 5 * 50)

    def test_a_replay_brings_back_the_costmaps_that_were_left_out(self, hunt: Path, tmp_path: Path) -> None:
        whole, everything = tmp_path / "whole.bag", StudyChange("recording.detail", "all")
        assert replay_again(hunt, everything, to=whole).difference is None
        kept, all_of_them = (Counter(messages(bag)) for bag in (hunt, whole))
        assert {message.topic for message in kept - all_of_them} == {names.SESSION}
        left_out = {message.topic for message in all_of_them - kept} - {names.SESSION}
        assert left_out
        assert all(topic.endswith("costmap/costmap") for topic in left_out)

    def test_a_recording_from_before_the_choice_of_detail_holds_all(self, tmp_path: Path) -> None:
        bag = tmp_path / "old.bag"
        setting = setting_of(dataclasses.replace(STUDY, recording=RecordingSection(detail=RecordingDetail.ALL)))
        opening = build_record(setting, PLAY, [legacy.SIMR, legacy.HIDER], "")
        opening = dataclasses.replace(opening, study=opening.study.replace("  detail: all\n", ""))
        assert "detail" not in opening.study
        with build_writer(setting, bag) as writer:
            said = Broadcast(build_publisher(setting), opening, setting.map.grid, [writer])
            roles = [build_simr(setting), build_hider(setting.templates, setting.study.seed)]
            session = Session(build_keeper(setting), roles, [BagRecorder(said)])
            for _ in range(400):
                session.step()
        assert_equal_replay(bag, 400)

    def test_things_in_the_way_and_what_befalls_robots(self, tmp_path: Path) -> None:
        study = read_study_text(
            Path("study.yaml"),
            "robots: 3\nthings:\n  - {name: visitor, shape: person, path: [[0, 2], [6, 2]], back_and_forth: true}\n"
            "mishaps:\n  - {robot: 2, what: dies, time: 4}\n  - {robot: 2, what: revives, time: 8}\n"
            "  - {robot: 3, what: carried, time: 6, to: [0, 4, 1]}\n",
        )
        record(tmp_path / "hunt.bag", dataclasses.replace(study, server=STUDY.server), 10.0)
        assert_equal_replay(tmp_path / "hunt.bag", 10 * 50)

    def test_all_that_can_be_asked_of_robots(self, tmp_path: Path) -> None:
        here = Pose2(1.0, 0.1 + 0.2, -0.0)
        crate = Thing("crate", ((0.1, 0.1), (-0.1, 0.1), (0.0, -0.1)), Pose2(3.0, 1.0, 0.0))
        asked: Mapping[int, Sequence[Request]] = {
            50: [DriveManually(0, Twist(0.3, 0.1), 40), SetPoseEstimate(1, here, np.diag([0.1, 0.1, 0.2]))],
            120: [GlobalLocalization(0), NomotionUpdate(1), ClearCostmaps(1)],
            150: [PutThing(crate), KillRobot(1)],
            200: [ReviveRobot(1), GoalRequest(1, "rviz-1", 4_000_000_000, Pose2(-2.0, 0.0, 1.0), 10**6)],
            230: [SimpleGoal(1, Pose2(2.0, 0.0, 1.0), 10**6 + 1), VelocityCommand(0, Twist(0.2, -0.4))],
            260: [CancelRequest(1, "", 0), InitialPose(0, here, np.eye(3) / 7)],
            290: [SetParameters(0, (("amcl.max_particles", 333), ("amcl.laser_z_rand", 0.3)))],
            300: [GoalRequest(0, "", 0, None, 10**6 + 2, "no frame"), RemoveThing("crate")],
            305: [KidnapRobot(1, Pose2(0.0, 4.0, 1.0))],
            310: [GoalRequest(7, "nobody", 0, here, 10**6 + 3)],
        }

        def doing(tick: int, session: Session) -> None:
            for request in asked.get(tick, ()):
                session.ask("/rviz", request)

        act(tmp_path / "asked.bag", STUDY, 400, doing)
        taken = [item.request for item in inputs(tmp_path / "asked.bag") if isinstance(item, ClientRequest)]
        assert len(taken) == sum(len(requests) for requests in asked.values())
        assert_equal_replay(tmp_path / "asked.bag", 400)

    def test_connections_of_every_kind_of_misbehaviour(self, tmp_path: Path) -> None:
        def doing(tick: int, session: Session) -> None:
            def send(connection: int, data: bytes) -> None:
                session.perform(session.router.receive_data(ConnectionId(connection), data, tick * 0.1))

            match tick:
                case 5:
                    session.router.connect(0.3)
                    session.router.connect(0.1 + 0.2)
                    send(1, b"%%setid Noise extended a\n%%goto Noise SimR 0 5\r\n%%pi")
                    send(2, b"\xff\x00 \r\n%%setid SimR\n")
                case 9:
                    send(1, b"ng\n%%error Noise Game thbridge {\n")
                    send(2, b"%%ping\n")
                case 20:
                    session.perform(session.router.report_backlog(ConnectionId(1), 1000))
                    session.perform(session.router.report_backlog(ConnectionId(1), 2**30))
                    session.perform(session.router.eof(ConnectionId(1)))
                case 30:
                    session.router.connect(3.0)
                    send(3, b"%%setid Noise\n%%where Noise SimR 0\n")
                case 200 | 400:
                    session.perform(session.router.advance(tick * 0.1))
                case 420:
                    session.router.connect(42.0)
                    session.perform(session.router.eof(ConnectionId(4)))

        act(tmp_path / "noise.bag", STUDY, 450, doing)
        kinds = {type(item) for item in inputs(tmp_path / "noise.bag")}
        assert kinds == {
            ConnectionOpened,
            BytesReceived,
            ConnectionBacklogged,
            ClockAdvanced,
            ConnectionClosed,
            ParticipantSent,
        }
        assert_equal_replay(tmp_path / "noise.bag", 450)

    def test_a_reader_that_lags_behind_while_it_is_sent_something(self, tmp_path: Path) -> None:
        sessions: list[Session] = []

        def perform(outputs: Sequence[RouterOutput]) -> None:
            for output in outputs:
                if isinstance(output, SendToClient) and sessions[0].tick > 30:
                    perform(sessions[0].router.report_backlog(output.connection, 2**30))

        def doing(tick: int, session: Session) -> None:
            if tick == 5:
                sessions.append(session)
                session.router.connect(0.0)
                session.perform(session.router.receive_data(ConnectionId(1), b"%%setid Deaf extended\n", 0.0))
                session.perform(session.router.receive_data(ConnectionId(1), subscription("Deaf"), 0.0))

        act(tmp_path / "deaf.bag", STUDY, 100, doing, SessionOutlets(perform))
        assert [type(item) for item in inputs(tmp_path / "deaf.bag") if isinstance(item, ConnectionBacklogged)] == [
            ConnectionBacklogged
        ]
        assert_equal_replay(tmp_path / "deaf.bag", 100)

    def test_robots_by_themselves(self, tmp_path: Path) -> None:
        setting = setting_of(STUDY)
        simr = build_simr(setting)
        record = build_record(setting, SIMR, [simr.name], "")
        with build_writer(setting, tmp_path / "simr.bag") as writer:
            said = Broadcast(build_publisher(setting), record, setting.map.grid, [writer])
            outpost = SimrSession(simr, [BagRecorder(said)])
            for tick in range(400):
                if tick in {3, 200}:
                    outpost.connected()
                if tick == 10:
                    outpost.receive(
                        encode_notice(
                            KEEPER, legacy.SIMR, Orders(1, (MoveOrder(1, 2), None), (90.0, 80.0), (0, 0), None)
                        )
                    )
                if tick == 100:
                    outpost.receive(legacy.GotoRoom(1, 3).message())
                    outpost.ask("/teleop", VelocityCommand(0, Twist(0.1, 0.0)))
                outpost.step()
        assert_equal_replay(tmp_path / "simr.bag", 400)

    def test_a_program_from_outside_that_comes_goes_and_comes_again(self, tmp_path: Path) -> None:
        setting = setting_of(STUDY)
        where: list[ListeningAddress] = []

        async def outside() -> None:
            while not where:
                await asyncio.sleep(0.01)
            for token, turns in (("first", 40), ("second", 1000)):
                role = bot_of(setting)
                client = TextClient(role.name, token, where[0].host, where[0].port)
                async with client.running():
                    for tick in range(turns):
                        heard = []
                        for event in client.take():
                            if isinstance(event, NameRegistered):
                                role.connected()
                            elif isinstance(event, TextMessage):
                                heard.append(event)
                        for message in role.step(tick, heard):
                            client.send(message)
                        await asyncio.sleep(0.01)

        async def both() -> None:
            participant = asyncio.create_task(outside())
            options = PlayOptions(20.0, tmp_path / "hunt.bag", frozenset({legacy.TABUI}), "person", 30.0)
            try:
                await play(setting, (bot_of(setting),), options, where.append, lambda tick_record: None)
            finally:
                participant.cancel()

        with pytest.raises(HuntUnfinished):
            asyncio.run(both())
        assert session_of(tmp_path / "hunt.bag").participant == ""
        opened = [item for item in inputs(tmp_path / "hunt.bag") if isinstance(item, ConnectionOpened)]
        assert len(opened) == 2
        assert_equal_replay(tmp_path / "hunt.bag", 30 * 50)


class TestDifferent:
    def test_another_seed_is_found_where_it_first_shows(self, hunt: Path) -> None:
        difference = replay_again(hunt, StudyChange("seed", "8")).difference
        assert difference is not None
        assert (difference.topic, difference.topic_number, difference.seconds) == ("/hunt/events", 1, 0.04)
        (field,) = difference.fields
        assert '"seed":7' in field.was
        assert '"seed":8' in field.now

    def test_one_parameter_of_one_robot_is_found(self, hunt: Path) -> None:
        done = replay_again(hunt, StudyChange("robot.amcl.max_particles", "300"))
        assert done.difference is not None
        assert done.ticks < 250

    def test_a_larger_team_says_more(self, hunt: Path) -> None:
        difference = replay_again(hunt, StudyChange("robots", "3")).difference
        assert difference is not None
        assert difference.topic == "/tf_static"

    def test_a_smaller_team_forgets_what_is_asked_of_robots_that_it_has_not(self, tmp_path: Path) -> None:
        def doing(tick: int, session: Session) -> None:
            if tick == 10:
                session.ask("/rviz", SimpleGoal(1, Pose2(0.0, 0.0, 0.0), 10**6))
                session.ask("/rviz", InitialPose(1, Pose2(0.0, 0.0, 0.0), np.eye(3)))

        act(tmp_path / "a.bag", STUDY, 50, doing)
        assert replay_again(tmp_path / "a.bag", StudyChange("robots", "1"), to_the_end=True).ticks == 50

    @pytest.mark.parametrize("forged", ["missing", "new", "changed", "moved"])
    def test_a_message_that_was_tampered_with_is_named(self, hunt: Path, tmp_path: Path, forged: str) -> None:
        victim = 2000
        with BagWriter(tmp_path / "forged.bag") as writer:
            for number, message in enumerate(messages(hunt)):
                topic = Topic(message.topic, message.msgtype)
                data = message.data
                if number == victim:
                    if forged == "missing":
                        continue
                    if forged == "moved":
                        topic = Topic("/elsewhere", message.msgtype)
                    if forged == "changed":
                        data = data[:-1] + bytes([data[-1] ^ 1])
                    if forged == "new":
                        writer.write(RosMessage(topic, message.stamp_ns, data))
                writer.write(RosMessage(topic, message.stamp_ns, data))
        difference = replay_again(tmp_path / "forged.bag").difference
        assert difference is not None
        assert difference.number == victim + (forged == "new")
        assert difference.seconds == pytest.approx(again_seconds(hunt, victim))

    def test_one_that_was_cut_off_is_the_same_up_to_its_end(self, hunt: Path, tmp_path: Path) -> None:
        whole = hunt.read_bytes()
        for share in (0.3, 0.61, 0.9):
            cut = tmp_path / f"cut{share}.bag"
            cut.write_bytes(whole[: int(share * len(whole))])
            reindex(cut)
            done = replay_again(cut)
            assert done.difference is None
            assert done.finished
            assert 0 < done.messages == len(list(messages(cut))) - 1


def again_seconds(bag: Path, number: int) -> float:
    return (list(messages(bag))[number].stamp_ns - 10**9) / 1e9


def test_it_tells_what_happens_from_the_time_asked_for(hunt: Path) -> None:
    told: list[TickRecord] = []
    setting = setting_of(read_study_text(hunt, session_of(hunt).study))
    asyncio.run(replay(hunt, setting, ReplayOptions(0.0, 12.0, None, False), told.append))
    assert [tick_record.tick for tick_record in told] == list(range(600, 800))


def test_a_participant_who_plays_anew_makes_the_best_of_a_changed_study(hunt: Path, tmp_path: Path) -> None:
    setting = setting_of(read_study_text(hunt, session_of(hunt).study))
    options = ReplayOptions(0.0, 0.0, tmp_path / "again.bag", True, BotStrategy.SUGGESTION)
    assert asyncio.run(replay(hunt, setting, options, lambda tick_record: None)).difference is None
    options = dataclasses.replace(options, to=tmp_path / "other.bag", participant=BotStrategy.NEAREST)
    assert asyncio.run(replay(hunt, setting, options, lambda tick_record: None)).difference is not None
    assert session_of(tmp_path / "other.bag").participant == "nearest"
    assert replay_again(tmp_path / "other.bag").difference is None


def test_bags_that_are_not_ours_are_refused(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "foreign.bag") as writer:
        writer.write(RosMessage(Topic("/chatter", "std_msgs/String"), 10**9, b"\0\0\0\0"))
    with pytest.raises(BadFile, match=r"foreign\.bag: this bag is not a recording by thbridge"):
        session_of(tmp_path / "foreign.bag")


def test_an_input_of_another_release_is_refused(hunt: Path, tmp_path: Path) -> None:
    with BagWriter(tmp_path / "other.bag") as writer:
        for message in messages(hunt):
            data = message.data.replace(b"said", b"sung") if message.topic == names.INPUTS else message.data
            writer.write(RosMessage(Topic(message.topic, message.msgtype), message.stamp_ns, data))
    with pytest.raises(BadFile, match="there is no kind of input 'sung'"):
        replay_again(tmp_path / "other.bag")


@pytest.mark.slow
def test_ten_minutes_of_three_robots_are_the_same_again(tmp_path: Path) -> None:
    rooms = [room.goal for room in setting_of(dataclasses.replace(STUDY, map="office")).map.rooms]

    def doing(tick: int, session: Session) -> None:
        # A hunt that is over leaves robots standing; then, and before, somebody else sends them about.
        if tick % 800 == 799:
            number = tick // 800
            goal = rooms[number * 5 % len(rooms)]
            session.ask("/tour", GoalRequest(number % 3, f"tour-{number}", 0, goal, 10**6 + number))

    act(tmp_path / "long.bag", dataclasses.replace(STUDY, map="office", robots=3), 30_000, doing)
    assert_equal_replay(tmp_path / "long.bag", 30_000)
    difference = replay_again(tmp_path / "long.bag", StudyChange("seed", "8")).difference
    assert difference is not None
    assert difference.seconds < 1.0


def test_robots_of_a_recording_from_before_a_key_do_as_they_did(hunt: Path) -> None:
    record = session_of(hunt)
    learning = recorded_study(hunt, record)
    assert learning.robot.amcl.odom_noise_learning_rate > 0.0
    kept = [line for line in record.study.splitlines() if "odom_noise_learning_rate" not in line]
    older = recorded_study(hunt, dataclasses.replace(record, study="\n".join(kept)))
    amcl = dataclasses.replace(learning.robot.amcl, odom_noise_learning_rate=0.0)
    assert older == dataclasses.replace(learning, robot=dataclasses.replace(learning.robot, amcl=amcl))
