"""Parsers of files, each with small whole files to make mistakes in, and the errors that it may answer with."""

import shutil
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.compiling import ROOT
from tests.thbridge.analysis import planting
from tests.thbridge.analysis.planting import Entry, Form, Line, Planted, clean, content
from thbridge.analysis.check import judge
from thbridge.analysis.export.folder import export_bag
from thbridge.analysis.report.gathering import read_games
from thbridge.analysis.summary import summarise
from thbridge.analysis.to_mcap import to_mcap
from thbridge.analysis.to_ros2 import to_ros2
from thbridge.experiment.design.experiment_file import read_experiment
from thbridge.files.errors import BadFile
from thbridge.files.map_files import read_map
from thbridge.files.table_files import TableFormat
from thbridge.files.template_files import read_template_set
from thbridge.hunt.codec import to_json
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import EndReason, GameEnded, GameStarted, RobotArrived, RobotDeparted, TreasureIdentified
from thbridge.hunt.rooms import Room
from thbridge.protocols.mavlink.frames.frame import Frame
from thbridge.protocols.mavlink.frames.framer import FrameParser
from thbridge.protocols.mavlink.tlog import Tlog
from thbridge.protocols.mavlink.traffic import Traffic
from thbridge.recording.bag import ros2
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.reading.scan import scan
from thbridge.recording.bag.repair import reindex
from thbridge.recording.journal import Journal, read_journal
from thbridge.ros.messages import pack
from thbridge.ros.messages.session_records import GameEvent, SessionRecord
from thbridge.ros.messages.types import GAME_EVENT, SESSION
from thbridge.study.study_file import load_study
from thbridge.study.text import commented_study


@dataclass(frozen=True)
class Target:
    """A parser of files.

    Attributes:
        quick: number of cases in the default tests.
        seeds: makes the folder of each whole file, with the names of those files in it that get mistakes.
        read: reads the file in its folder, by its name.
    """

    quick: int
    seeds: Callable[[Path], tuple[str, ...]]
    read: Callable[[Path, str], None]


STARTED = GameStarted(7, 1, 2, 100.0, 5.0, 2.0, 1.0, CostMatrix.of_map_times(((99.0, 5.0), (99.0, 99.0))))
EVENTS = (
    RobotDeparted(0, Room(1), 5.0),
    RobotArrived(0, Room(1)),
    TreasureIdentified(Room(1), 0, "Größe\n", 10, 2.0),
    GameEnded(EndReason.ALL_VISITED, 10),
)


def _recording() -> Planted:
    """A small recording of a robot, with a session and a game of ours."""
    planted = clean()
    session = SessionRecord("seed: 1\n", 1, {"thbridge": "0.1"}, "play", ("simr",), "person")
    planted.entries.insert(
        0, Entry(Line("/thbridge/session", SESSION, "1"), planting.START, data=pack.session(0, session))
    )
    for number, event in enumerate((STARTED, *EVENTS)):
        record = GameEvent(type(event).__name__.lower(), 0, 1, to_json(event))
        stamp = planting.START + number * planting.STEP
        planted.entries.append(Entry(Line("/hunt/events", GAME_EVENT), stamp, data=pack.game_event(number, record)))
    return planted


def _bags(folder: Path) -> tuple[str, ...]:
    planted = _recording()
    (folder / "plain.bag").write_bytes(content(planted))
    (folder / "lz4.bag").write_bytes(content(planted, Form(lz4_flags={"block_linked": False})))
    return "plain.bag", "lz4.bag"


def _read_bag(folder: Path, name: str) -> None:
    bag = folder / name
    for step in (
        lambda: summarise(bag),
        lambda: judge(scan(bag)),
        lambda: read_games(messages(bag)),
        lambda: export_bag(bag, folder / "tables", tuple(TableFormat)),
        lambda: to_mcap(bag, folder / "new.mcap"),
        lambda: to_ros2(bag, folder / "ros2"),
        lambda: reindex(bag),
    ):
        with suppress(BadFile):
            step()


@cache
def _other_recordings() -> dict[str, bytes]:
    with TemporaryDirectory() as made:
        folder = Path(made)
        (folder / "a.bag").write_bytes(content(_recording()))
        to_mcap(folder / "a.bag", folder / "ros1.mcap", "none")
        to_ros2(folder / "a.bag", folder / "ros2", packed=False)
        files = [folder / "ros1.mcap", *(folder / "ros2").iterdir()]
        return {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}


def _others(folder: Path) -> tuple[str, ...]:
    for name, data in _other_recordings().items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(data)
    return tuple(_other_recordings())


def _read_other(folder: Path, name: str) -> None:
    path = folder / name
    ros2._converted.cache_clear()
    summarise(path if path.suffix == ".mcap" and "/" not in name else path.parent)


def _studies(folder: Path) -> tuple[str, ...]:
    (folder / "all.yaml").write_text(commented_study(), encoding="utf-8")
    (folder / "some.yaml").write_text("robots: 3\nmap: office\ngame: {energy: 50}\nmavlink:\n  udp: [10.0.0.1:14550]\n")
    return "all.yaml", "some.yaml"


def _experiments(folder: Path) -> tuple[str, ...]:
    shutil.copytree(ROOT / "thbridge" / "experiment" / "example", folder, dirs_exist_ok=True)
    return "experiment.yaml", "understood.yaml"


def _templates(folder: Path) -> tuple[str, ...]:
    shutil.copytree(ROOT / "templates" / "four-properties", folder, dirs_exist_ok=True)
    return tuple(path.name for path in sorted(folder.iterdir()) if path.is_file() and path.suffix != ".md")


def _maps(folder: Path) -> tuple[str, ...]:
    shutil.copytree(ROOT / "maps" / "arena8", folder, dirs_exist_ok=True)
    return "map.yaml", "map.pgm", "rooms.yaml", "mapTimes"


def _tlogs(folder: Path) -> tuple[str, ...]:
    traffic = [
        Traffic(0, incoming, "station", Frame(1, 1, number, 0, bytes(range(9)), 50))
        for number in range(8)
        for incoming in (True, False)
    ]
    (folder / "a.tlog").write_bytes(Tlog().records(1_000_000, traffic))
    return ("a.tlog",)


def _read_tlog(folder: Path, name: str) -> None:
    parser = FrameParser()
    for found in (*parser.receive_data((folder / name).read_bytes()), *parser.end()):
        assert isinstance(found, Frame) or found.size > 0


def _journals(folder: Path) -> tuple[str, ...]:
    with Journal.start(folder, STARTED) as journal:
        journal.append(EVENTS)
    # As older releases wrote them, without checksums, which would keep mistakes from what reads events.
    (folder / "old.jsonl").write_text("".join(f"{to_json(event)}\n" for event in (STARTED, *EVENTS)))
    return journal.path.name, "old.jsonl"


TARGETS = {
    "bag": Target(60, _bags, _read_bag),
    "other-recordings": Target(40, _others, _read_other),
    "study": Target(60, _studies, lambda folder, name: _taken(load_study(folder / name))),
    "experiment": Target(20, _experiments, lambda folder, name: _taken(read_experiment(folder / "experiment.yaml"))),
    "templates": Target(150, _templates, lambda folder, name: _taken(read_template_set(folder))),
    "maps": Target(60, _maps, lambda folder, name: _taken(read_map(folder))),
    "tlog": Target(300, _tlogs, _read_tlog),
    "journal": Target(300, _journals, lambda folder, name: _taken(read_journal(folder / name))),
}


def _taken(read: object) -> None:
    """Take a value and do nothing with it."""
