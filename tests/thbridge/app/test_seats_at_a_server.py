"""Programs of several seats at a real text server, with real robots: who is admitted, and what each may do and see."""

import asyncio
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path

import pytest

from tests.support.hunts.recorded_hunts import assert_equal_replay
from thbridge.app.compose.game import build_bot, seat_seed
from thbridge.app.compose.setting import StudySetting, read_setting
from thbridge.app.play import HuntUnfinished, PlayOptions, play
from thbridge.app.programs import reason_of, tabui
from thbridge.app.session.session import TickRecord
from thbridge.hunt.events import Event, RobotDeparted, SeatTaken, TeamEntry, TreasureIdentified
from thbridge.hunt.seats import PlayedBy
from thbridge.roles.participant.tabui import ParticipantUpdate, TabUI
from thbridge.roles.shared.notices import FloorPlan, PlannedPaths, PoseTelemetry
from thbridge.sockets.addresses import ListeningAddress
from thbridge.sockets.errors import CannotListen
from thbridge.sockets.reconnecting import ConnectionLost
from thbridge.study.study_file import load_study
from thbridge.text_protocol.wire.canonical import GotoPoint, MoveByHand, MoveDirection, PoseQuery, encode
from thbridge.text_protocol.wire.legacy import AskTreasure, GotoRoom, NameTreasure, RoomReached

STUDY = """
robots: 2
server: {port: 0, tell_refusals: true}
dialogue: {condition: collaborator}
seats:
  - {name: driver, robots: [1, 2], names_treasures: false}
  - {name: namer, takes_over: false, sees_map: false}
"""
SEATS = ("driver", "namer")
OUTSIDE = frozenset(f"TabUI-{seat}" for seat in SEATS)
TIMEOUT = 120


class Lab:
    """A game whose participants are programs that connect to its server.

    Args:
        setting: the study.
        visit: what happens at the server; the game stops afterwards.
        bag: path of the recording; None for none.

    Attributes:
        first: the first tick.
        last: the last tick so far.
        events: events of the game so far.
        refusals: refused requests and lines so far.
        team: entries about the participants so far.
        joined: True once a participant has joined.
        port: port of the server.
        lost: reasons why programs lost their connections, by seat.
    """

    def __init__(
        self, setting: StudySetting, visit: "Callable[[Lab], Awaitable[None]]", bag: Path | None = None
    ) -> None:
        self.setting = setting
        self.first: TickRecord | None = None
        self.last: TickRecord | None = None
        self.events: list[Event] = []
        self.refusals: list[str] = []
        self.team: list[TeamEntry] = []
        self.joined = False
        self.port = 0
        self.lost: dict[str, list[ConnectionLost]] = {}
        self._visit = visit
        self._bag = bag
        self._over = False

    def run(self) -> None:
        async def visit() -> None:
            try:
                async with asyncio.timeout(TIMEOUT):
                    await self._visit(self)
            finally:
                self._over = True

        async def run() -> None:
            def ready(where: ListeningAddress | CannotListen) -> None:
                assert isinstance(where, ListeningAddress)
                self.port = where.port
                visits.append(asyncio.ensure_future(visit()))

            visits: list[asyncio.Future[None]] = []
            options = PlayOptions(0.0, self._bag, OUTSIDE, "", float("inf"), left=lambda: self._over)
            with pytest.raises(HuntUnfinished):
                await play(self.setting, (), options, ready, self._note)
            await visits[0]

        asyncio.run(run())

    async def until(self, condition: Callable[[], bool]) -> None:
        """Wait until a condition is true, while ticks run."""
        while not condition():
            await asyncio.sleep(0.0)

    def play_as(
        self, seat: str, observer: "Observer | None" = None, token: str = "", by: PlayedBy = PlayedBy.PERSON
    ) -> "asyncio.Future[object]":
        """Start a program with a simulated participant, which takes a seat."""
        bot = build_bot(self.setting.templates, "nearest", seat_seed(1, seat))
        role = TabUI(bot, observer, seat=seat, by=by)
        lost = self.lost.setdefault(role.name if by is PlayedBy.RESEARCHER else seat, [])
        program = tabui(role, "127.0.0.1", self.port, token or f"t-{seat}", lost.append, lambda view: None)
        return asyncio.ensure_future(program)

    def _note(self, tick: TickRecord) -> None:
        self.first, self.last = self.first or tick, tick
        self.events += tick.events
        self.refusals += map(str, tick.refusals)
        self.joined = self.joined or bool(tick.team)
        self.team += tick.team

    @property
    def tick(self) -> int:
        """Number of the last tick; -1 before the first game."""
        return -1 if self.last is None or self.last.game is None else self.last.tick


class Observer:
    """Front end of a program, which stores what it receives."""

    def __init__(self) -> None:
        self.kinds: set[type] = set()
        self.sees_poses = False

    def observe(self, level: ParticipantUpdate) -> None:
        """Store the kind of a message."""
        self.kinds.add(type(level))
        if isinstance(level, PoseTelemetry):
            self.sees_poses |= bool(level.poses or level.motions)


@pytest.fixture(scope="module")
def setting(tmp_path_factory: pytest.TempPathFactory) -> StudySetting:
    return setting_in(tmp_path_factory.mktemp("study"), STUDY)


def setting_in(folder: Path, text: str) -> StudySetting:
    path = folder / "study.yaml"
    path.write_text(text)
    return read_setting(load_study(path).value, folder)


def test_each_program_does_and_sees_what_its_seat_may(setting: StudySetting) -> None:
    driver, namer = Observer(), Observer()

    async def visit(lab: Lab) -> None:
        running = [lab.play_as("driver", driver), lab.play_as("namer", namer)]
        await lab.until(lambda: any(isinstance(event, TreasureIdentified) for event in lab.events))
        for each in running:
            each.cancel()

    lab = Lab(setting, visit)
    lab.run()
    by = {type(event): event.seat for event in lab.events if isinstance(event, RobotDeparted | TreasureIdentified)}
    assert by == {RobotDeparted: "driver", TreasureIdentified: "namer"}
    assert driver.kinds >= {PoseTelemetry, PlannedPaths, FloorPlan}
    # Without the map, telemetry contains only the simulated time.
    assert driver.sees_poses and not namer.sees_poses
    assert namer.kinds.isdisjoint({PlannedPaths, FloorPlan}) and PoseTelemetry in namer.kinds


def test_a_participant_of_2016_is_refused_with_the_reason(setting: StudySetting, caplog) -> None:
    async def visit(lab: Lab) -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", lab.port)
        writer.write(b"%%setid TabUI\n")
        said = await reader.read()
        reason, end = said.decode().splitlines()
        assert reason.startswith("%%error") and "this game has several seats, which programs of 2016" in reason
        assert end.startswith("%%sshhuuttddoowwnn")
        writer.close()

    Lab(setting, visit).run()
    assert (
        "the program TabUI is refused: this game has several seats, which programs of 2016 cannot take" in caplog.text
    )


def test_lines_in_the_name_of_a_seat_have_no_effect(setting: StudySetting) -> None:
    go, name = GotoRoom(0, 1).message(), NameTreasure(1, "moon").message()
    lines = [
        *(replace(message, sender=sender) for message in (go, name) for sender in ("TabUI-driver", "TabUI")),
        AskTreasure(1).message(),
        RoomReached(0, 1).message(),
        *(
            encode(value, "Spy", "SimR")
            for value in (GotoPoint(1, 1.0, 1.0), MoveByHand(1, MoveDirection.FORWARD, 5), PoseQuery(0))
        ),
    ]

    answers: list[bytes] = []

    async def visit(lab: Lab) -> None:
        await lab.until(lambda: lab.tick >= 0)
        reader, writer = await asyncio.open_connection("127.0.0.1", lab.port)
        writer.write("".join(f"{line}\n" for line in ("%%setid Spy", *(each.line() for each in lines))).encode())
        end = lab.tick + 100
        await lab.until(lambda: lab.tick > end)
        writer.write(b"%%getid\n")
        answers.append(await reader.readuntil(b"%%setid 1"))
        writer.close()

    lab = Lab(setting, visit)
    lab.run()
    assert not any(isinstance(event, RobotDeparted | TreasureIdentified) for event in lab.events)
    assert lab.first is not None and lab.first.snapshot is not None
    assert lab.last is not None and lab.last.snapshot is not None
    assert (lab.first.snapshot.truth.poses == lab.last.snapshot.truth.poses).all()
    assert len([refusal for refusal in lab.refusals if "several seats" in refusal]) >= len(lines)
    assert b"%%pose" not in answers[0]


def test_a_program_learns_why_it_has_no_seat(setting: StudySetting) -> None:
    async def visit(lab: Lab) -> None:
        running = [lab.play_as(seat) for seat in ("", "pilot", "driver")]
        await lab.until(lambda: lab.joined)
        running.append(lab.play_as("driver", token="another"))
        await lab.until(lambda: all(lab.lost[seat] for seat in ("", "pilot", "driver")))
        for each in running:
            each.cancel()

    lab = Lab(setting, visit)
    lab.run()
    remedy = "use --seat with one of these names: driver, namer; trying again"
    assert reason_of(lab.lost[""][0]) == f"the server refused the connection: this game has several seats; {remedy}"
    assert reason_of(lab.lost["pilot"][0]).endswith(f"this game has no seat pilot; {remedy}")
    assert reason_of(lab.lost["driver"][0]).startswith("another program uses this name at the server")


def test_a_researcher_plays_a_seat_until_its_person_is_there(setting: StudySetting, tmp_path: Path) -> None:
    async def visit(lab: Lab) -> None:
        running = [lab.play_as("driver", by=PlayedBy.RESEARCHER), lab.play_as("namer")]
        await lab.until(lambda: any(isinstance(event, RobotDeparted) for event in lab.events))
        running.append(lab.play_as("driver"))
        await lab.until(lambda: bool(lab.lost["Researcher-driver"]))
        assert not lab.lost["driver"]
        running.append(lab.play_as("namer", token="another", by=PlayedBy.RESEARCHER))
        await lab.until(lambda: bool(lab.lost["Researcher-namer"]))
        for each in running:
            each.cancel()

    bag = tmp_path / "hunt.bag"
    lab = Lab(setting, visit, bag)
    lab.run()
    taken = [(each.seat, each.by) for each in lab.team if isinstance(each, SeatTaken)]
    assert [by for seat, by in taken if seat == "driver"] == [PlayedBy.RESEARCHER, PlayedBy.PERSON]
    assert [by for seat, by in taken if seat == "namer"] == [PlayedBy.PERSON]
    for seat in SEATS:
        answer = reason_of(lab.lost[f"Researcher-{seat}"][0])
        assert f"a person plays the seat {seat} now; take a seat that is empty, or whose person is away" in answer
    assert lab.last is not None
    assert_equal_replay(bag, lab.last.tick + 1)
