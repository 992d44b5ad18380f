"""Parsers of files, each with small whole files to make mistakes in, and the errors that it may answer with."""

import shutil
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from sim.parameters import RobotParameters
from tests.support.bags import bags_with_faults
from tests.support.bags.bags_with_faults import Entry, Form, Line, Planted, clean, content
from tests.support.bags.ros2_bags import written
from tests.support.maps.small_arenas import GRID
from tests.support.project import ROOT
from tests.support.ros.nav2_parameters import AMCL, CONTROLLER
from thbridge.analysis.bag_summary import summarise
from thbridge.analysis.check import judge
from thbridge.analysis.export.folder import export_bag
from thbridge.analysis.report.builder import read_games
from thbridge.analysis.to_mcap import to_mcap
from thbridge.analysis.to_ros2 import to_ros2
from thbridge.batch.design import read_design
from thbridge.batch.status import status_of
from thbridge.experiment.design.experiment_file import ExperimentDesign, read_experiment
from thbridge.experiment.questionnaires.form import read_form
from thbridge.experiment.rehearsal.people import read_people
from thbridge.experiment.store.event_log import read_log
from thbridge.files.argument_files import read_framework
from thbridge.files.errors import BadFile
from thbridge.files.game_files import read_rulebook
from thbridge.files.image_files import read_image
from thbridge.files.keys.key_ring import RING, KeyRing, Right
from thbridge.files.map_files import read_map
from thbridge.files.ros.parameters import read_ros_parameters
from thbridge.files.tables.csv_files import read_columns
from thbridge.files.tables.table_files import TableFormat
from thbridge.files.template_files import read_template_set
from thbridge.files.word_files import read_language
from thbridge.hunt.codec import to_json
from thbridge.hunt.costs import CostMatrix
from thbridge.hunt.events import EndReason, GameEnded, GameStarted, RobotArrived, RobotDeparted, TreasureIdentified
from thbridge.hunt.rooms import Room
from thbridge.mavlink.files.signing_timestamps import SUFFIX, TimestampFile
from thbridge.mavlink.wire.frames.frame import Frame
from thbridge.mavlink.wire.frames.framer import FrameParser
from thbridge.mavlink.wire.frames.signing import KnownTimestamps
from thbridge.mavlink.wire.tlog import Tlog
from thbridge.mavlink.wire.traffic import Traffic
from thbridge.recording.bag import ros2
from thbridge.recording.bag.options import Compression
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.reading.scan import scan
from thbridge.recording.bag.repair import reindex
from thbridge.recording.journal import Journal, read_journal
from thbridge.ros.messages import pack
from thbridge.ros.messages.session_records import GameEvent, SessionRecord
from thbridge.ros.messages.types import GAME_EVENT, SESSION
from thbridge.study.study_file import load_study
from thbridge.study.text import commented_study
from ui.commands.offline.drive_files import read_moving


@dataclass(frozen=True)
class Target:
    """A parser of files.

    Attributes:
        quick: number of cases in the default tests.
        seeds: makes the folder of each whole file, with the names of those files in it that get mistakes.
        read: reads the file in its folder, by its name.
        writes: True where reading leaves files in the folder, which is then made anew for each case.
    """

    quick: int
    seeds: Callable[[Path], tuple[str, ...]]
    read: Callable[[Path, str], None]
    writes: bool = False


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
        0, Entry(Line("/thbridge/session", SESSION, "1"), bags_with_faults.START, data=pack.session(0, session))
    )
    for number, event in enumerate((STARTED, *EVENTS)):
        record = GameEvent(type(event).__name__.lower(), 0, 1, to_json(event))
        stamp = bags_with_faults.START + number * bags_with_faults.STEP
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
        to_ros2(folder / "a.bag", folder / "ros2", Compression.NONE)
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
    own = (path.name for path in sorted(folder.iterdir()) if path.is_file() and path.suffix != ".md")
    return (*own, "de/words.yaml", "de/DialogueText")


def _maps(folder: Path) -> tuple[str, ...]:
    shutil.copytree(ROOT / "maps" / "arena8", folder, dirs_exist_ok=True)
    return "map.yaml", "map.pgm", "rooms.yaml", "mapTimes", "de/words.yaml"


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


def _copied(*names: str) -> Callable[[Path], tuple[str, ...]]:
    """Make the whole files of files that come with the project."""

    def seeds(folder: Path) -> tuple[str, ...]:
        for name in names:
            shutil.copy(ROOT / name, folder)
        return tuple(Path(name).name for name in names)

    return seeds


def _texts(**texts: str) -> Callable[[Path], tuple[str, ...]]:
    """Make the whole files of texts, whose names have _ for a dot."""

    def seeds(folder: Path) -> tuple[str, ...]:
        for name, text in texts.items():
            (folder / name.replace("_", ".")).write_text(text)
        return tuple(name.replace("_", ".") for name in texts)

    return seeds


FORMS = ROOT / "thbridge" / "experiment" / "questionnaires" / "forms"
GAMES = ROOT / "thbridge" / "dialogue" / "games" / "rules"
LANGUAGE = ROOT / "thbridge" / "dialogue" / "wording" / "languages" / "en"


def _sweeps(folder: Path) -> tuple[str, ...]:
    (folder / "study.yaml").write_text("map: arena8\nrobots: 2\n")
    (folder / "sweep.yaml").write_text(
        "study: study.yaml\nreplicates: 3\nverify: 1\nchunk: 20\nbase: {game: {picture_cost: 3}}\n"
        "factors: {robots: [1, 2], game.energy: [40, 90.5]}\n"
    )
    return "sweep.yaml", "study.yaml"


MANIFEST = """\
{"layout": 1, "versions": {"thbridge": "0.1.0"}, "design": {"factors": ["robots"],
 "levels": {"1": {"robots": "1"}, "2": {"robots": "2"}}, "seeds": [1, 2, 3], "max_seconds": 60.0,
 "measures": ["score"], "one_bag_in": 0, "one_verified_in": 10, "chunk": 2, "files": {}, "studies": {}}}
"""


def _languages(folder: Path) -> tuple[str, ...]:
    shutil.copytree(LANGUAGE, folder / "ours", dirs_exist_ok=True)
    return tuple(f"ours/{path.name}" for path in sorted(LANGUAGE.glob("*.yaml")))


def _games(folder: Path) -> tuple[str, ...]:
    shutil.copytree(GAMES, folder, dirs_exist_ok=True)
    return tuple(path.name for path in sorted(GAMES.glob("*.yaml")))


PICTURES = ("PNG", "BMP", "GIF", "TIFF", "TGA", "PCX", "WEBP", "JPEG")


def _images(folder: Path) -> tuple[str, ...]:
    picture = Image.linear_gradient("L").resize((20, 10))
    for kind in PICTURES:
        picture.save(folder / f"a.{kind.lower()}", kind)
    (folder / "a.p5").write_bytes(b"P5\n# a\n20 10\n255\n" + picture.tobytes())
    (folder / "a.p2").write_text("P2 4 2 255\n0 1 2 3\n4 5 6 255\n")
    return (*(f"a.{kind.lower()}" for kind in PICTURES), "a.p5", "a.p2")


def _rings(folder: Path) -> tuple[str, ...]:
    ring = KeyRing(folder, lambda: "2026-01-01T00:00:00Z")
    ring.add("anna", [Right.WATCH], "a" * 20, None)
    ring.add("bert", [Right.WATCH, Right.INTERVENE], "b" * 20, "2027-01-01T00:00:00Z")
    ring.revoke("anna")
    return (RING,)


def _read_ring(folder: Path, name: str) -> None:
    (folder / name).chmod(0o600)
    KeyRing(folder, lambda: "2026-01-01T00:00:00Z").holder("b" * 20)


def _timestamps(folder: Path) -> tuple[str, ...]:
    TimestampFile(folder / "key").write(KnownTimestamps(1000, {(0, 255, 190): 7, (1, 245, 190): 900}))
    return (f"key{SUFFIX}",)


def _logs(folder: Path) -> tuple[str, ...]:
    return _copied(*(f"tests/system/studies_of_0_1/with-people/store/{name}" for name in ("log", "log-head")))(folder)


def _packed(folder: Path) -> tuple[str, ...]:
    names: list[str] = []
    for storage in StoragePlugin:
        for mode in (CompressionMode.FILE, CompressionMode.MESSAGE):
            made = written(folder / f"{storage.name}-{mode.name}", storage, mode)
            names += [path.relative_to(folder).as_posix() for path in sorted(made.iterdir())]
    return tuple(names)


ROS = """\
amcl: {max_particles: 2000, odom_model_type: diff, initial_pose_x: 1.5}
move_base:
  controller_frequency: 10.0
  base_local_planner: dwa_local_planner/DWAPlannerROS
  local_costmap: {update_frequency: 5.0, width: 3.0, plugins: [{name: inflation, type: "costmap_2d::InflationLayer"}]}
  global_costmap: &a {robot_radius: 0.3, footprint: [[0.3, 0.2], [-0.3, 0.2], [-0.3, -0.2]]}
DWAPlannerROS: {max_vel_x: 0.5, vx_samples: 6}
"""
THINGS = """\
things:
  - {name: crate, shape: polygon, corners: [[0.3, 0.3], [-0.3, 0.3], [-0.3, -0.3]], at: [1, 2, 0.5], appears: 2.0}
  - {name: walker, shape: person, path: [[1, 1], [2, 1.5]], speed: 0.4, back_and_forth: true, vanishes: 9.0}
"""
CSV = 'x, y,yaw\n1,2,3\n\n-0.5,1e3,"4"\n'


@cache
def _design() -> ExperimentDesign:
    return read_experiment(ROOT / "thbridge" / "experiment" / "example" / "experiment.yaml")


TARGETS = {
    "bag": Target(20, _bags, _read_bag, writes=True),
    "other-recordings": Target(15, _others, _read_other, writes=True),
    "packed-recordings": Target(5, _packed, _read_other, writes=True),
    "study": Target(60, _studies, lambda folder, name: _taken(load_study(folder / name))),
    "experiment": Target(10, _experiments, lambda folder, name: _taken(read_experiment(folder / "experiment.yaml"))),
    "experiment-log": Target(60, _logs, lambda folder, name: _taken(read_log(folder / "log")), writes=True),
    "people": Target(
        40,
        _copied("thbridge/experiment/example/rehearsal.yaml"),
        lambda folder, name: _taken(read_people(folder / name, _design())),
    ),
    "form": Target(
        60,
        _copied(*(path.relative_to(ROOT).as_posix() for path in sorted(FORMS.glob("*.yaml")))),
        lambda folder, name: _taken(read_form(folder / name)),
    ),
    "sweep": Target(15, _sweeps, lambda folder, name: _taken(read_design(folder / "sweep.yaml"))),
    "sweep-folder": Target(150, _texts(sweep_json=MANIFEST), lambda folder, name: _taken(status_of(folder))),
    "templates": Target(150, _templates, lambda folder, name: _taken(read_template_set(folder))),
    "languages": Target(4, _languages, lambda folder, name: _taken(read_language((folder,), "ours"))),
    "dialogue-games": Target(20, _games, lambda folder, name: _taken(read_rulebook((folder,)))),
    "frameworks": Target(
        150,
        _texts(
            a_apx="% two\narg(x).arg( y ) . att(x,y). % one attack\n\n",
            a_tgf="a\nb\n#\na b\n",
            a_af="# ours\np af 3\n1 2\n2 3\n",
        ),
        lambda folder, name: _taken(read_framework(folder / name)),
    ),
    "maps": Target(60, _maps, lambda folder, name: _taken(read_map(folder))),
    "images": Target(200, _images, lambda folder, name: _taken(read_image(folder / name))),
    "ros-parameters": Target(
        80,
        _texts(ros_yaml=ROS, nav2_yaml=AMCL + CONTROLLER),
        lambda folder, name: _taken(read_ros_parameters([folder / name], RobotParameters())),
    ),
    "moving": Target(80, _texts(things_yaml=THINGS), lambda folder, name: _taken(read_moving(folder / name, GRID))),
    "csv": Target(150, _texts(a_csv=CSV), lambda folder, name: _taken(read_columns(folder / name, ("x", "y", "yaw")))),
    "tlog": Target(300, _tlogs, _read_tlog),
    "journal": Target(300, _journals, lambda folder, name: _taken(read_journal(folder / name))),
    "key-ring": Target(100, _rings, _read_ring),
    "timestamps": Target(100, _timestamps, lambda folder, name: _taken(TimestampFile(folder / "key").read())),
}


def _taken(read: object) -> None:
    """Take a value and do nothing with it."""
