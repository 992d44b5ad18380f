"""Every kind of file that commands write, into a folder on a full disk and into a read-only one.

Nothing is lost and nothing half written: afterwards the disk holds what it held before, to the byte. One message names
the file, the reason and a remedy; and once there is room, the same command does its work.
"""

import multiprocessing
import os
import re
import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import pytest

from tests.support.bags.bags_with_faults import clean
from tests.support.bags.bags_with_faults import write as write_planted
from tests.support.bags.foreign_bags import FIRST, Robot, write, write_map
from tests.support.disks.small_disk import SmallDisk, why_not
from tests.support.mavlink.recorded_stations import beating, record
from thbridge.files.disk.whole import PART
from thbridge.recording.bag.reading.reader import info

SIZE = 64 << 20
PATIENCE = 300.0
FULL, READ_ONLY = "no space left on device|disk i/o error", "read-only file system"  # the second is SQLite's

Contents = dict[str, bytes | None]


def contents(folder: Path) -> Contents:
    """All that is in a folder: the bytes of files by their paths; None of a folder."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() if path.is_file() else None for path in folder.rglob("*")
    }


def put(folder: Path, there: Contents) -> None:
    for name, data in sorted(there.items()):
        if data is None:
            (folder / name).mkdir()
        else:
            (folder / name).write_bytes(data)


@dataclass(frozen=True)
class Ended:
    code: int | None
    said: str
    out: str


class Commands:
    """Our commands as processes; those of a server of processes, which has loaded them, begin at once."""

    def __init__(self, scratch: Path) -> None:
        self._processes = multiprocessing.get_context("forkserver")
        self._processes.set_forkserver_preload([__name__, "ui.cli"])
        self._scratch = scratch

    def run(self, words: list[str], folder: Path) -> Ended:
        out, err = self._scratch / "out", self._scratch / "err"
        process = self._processes.Process(target=run_command, args=(words, folder, out, err))
        process.start()
        process.join(PATIENCE)
        if process.exitcode is None:
            process.kill()
        return Ended(process.exitcode, err.read_text(), out.read_text())


def run_command(words: list[str], folder: Path, out: Path, err: Path) -> None:
    """Be `thbridge WORDS` in a folder."""
    from ui.cli import main  # noqa: PLC0415 - it is loaded in the server of processes

    os.chdir(folder)
    os.environ["COLUMNS"] = "200"
    for path, number in ((out, 1), (err, 2)):
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, number)
        os.close(file)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    sys.argv = ["thbridge", *words]
    main()


class Sources:
    """What commands read, each made when it is first wanted; none of it is on the small disk."""

    def __init__(self, folder: Path, commands: Commands) -> None:
        self._folder = folder
        self._commands = commands

    def made(self, name: str, make: Callable[[Path], object]) -> Path:
        path = self._folder / name
        if not path.exists():
            make(path)
        return path

    def run(self, *words: object, code: int = 0) -> None:
        ended = self._commands.run(list(map(str, words)), self._folder)
        assert ended.code == code, ended.said

    @property
    def bag(self) -> Path:
        return self.made("a.bag", lambda path: write_planted(path, clean()))

    @property
    def drive(self) -> Path:
        write_map(self._folder)
        return self.made("drive.bag", lambda path: write(path, Robot(), seconds=4.0))

    @property
    def drive_map(self) -> Path:
        return self.drive.with_name("map.yaml")

    @property
    def hunt(self) -> Path:
        words = ("play", "--json", "--port", 0, "--seed", 7, "--max-seconds", 6, "--mavlink", "--bag")
        return self.made("hunt.bag", lambda path: self.run(*words, path, code=1))

    @property
    def mavlink(self) -> Path:
        return self.made("mavlink.bag", lambda path: record(path, 150, beating({})))

    @property
    def plan(self) -> Path:
        def make(path: Path) -> None:
            self.run("study", "new", path)
            text = (path / "experiment.yaml").read_text()
            (path / "experiment.yaml").write_text(text.replace("quota: 24", "quota: 2"))

        return self.made("plan", make)

    @property
    def rehearsed(self) -> Path:
        return self.made("rehearsed", lambda path: self.run("study", "rehearse", self.plan, "--no-games", "--to", path))

    @property
    def person(self) -> str:
        from thbridge.experiment.folder import ExperimentFolder  # noqa: PLC0415

        people = [entry.event.participant for entry in ExperimentFolder(self.rehearsed).entries()]
        return next(filter(None, people))

    @property
    def design(self) -> Path:
        text = "factors:\n  robots: [1, 2]\nseeds: [3, 5]\nmax_seconds: 1\n"
        return self.made("design.yaml", lambda path: path.write_text(text))

    @property
    def sweep(self) -> Path:
        words = ("sweep", "run", self.design, "--processes", 1, "--out")
        return self.made("sweep", lambda path: self.run(*words, path))


class Halves(Enum):
    """What a disk leaves that fills up when half is written."""

    NOTHING = "nothing"
    RECORDING = "a recording up to then, whole"
    RESUMED = "what was done; the same command goes on"


def nothing(_folder: Path, _sources: Sources) -> None:
    pass


@dataclass(frozen=True)
class Kind:
    """A kind of file.

    Attributes:
        words: of the command; `{bag}` is one of the sources, `{disk}` the folder to write into.
        prepare: puts onto the disk what is there before, and has to stay as it was.
        told: how the message names what cannot be written; a pattern.
        codes: exit codes: when nothing can be written; when half can be; when all can be (None: it goes on for ever).
        left: pattern of the files that may be there afterwards.
        halves: see there.
        quick: True for what belongs to the default run.
    """

    words: str
    prepare: Callable[[Path, Sources], object] = nothing
    told: str = "/new|/study"
    codes: tuple[int, int, int | None] = (2, 2, 0)
    left: str = "$^"
    halves: Halves = Halves.NOTHING
    quick: bool = False


def older(name: str) -> Callable[[Path, Sources], object]:
    return lambda folder, sources: (folder / name).write_bytes(b"what was there before\n")


def copied(source: str, name: str) -> Callable[[Path, Sources], object]:
    def copy(folder: Path, sources: Sources) -> None:
        path: Path = getattr(sources, source)
        (shutil.copytree if path.is_dir() else shutil.copy)(path, folder / name)

    return copy


def with_key(folder: Path, sources: Sources) -> None:
    sources.run("keys", "new", "ada", "--keys", folder / "keys")


def with_backup(folder: Path, sources: Sources) -> None:
    """A study with a backup, and an event since."""
    shutil.copytree(sources.rehearsed, folder / "study")
    sources.run("study", "backup", folder / "study", "--to", folder / "new")
    (folder / "study" / "recordings").mkdir()
    (folder / "study" / "recordings" / "notes").write_bytes(bytes(100_000))


RECORDING, RESUMED = Halves.RECORDING, Halves.RESUMED
LOCALIZE = f"localize {{drive}} --map {{drive_map}} --initial-pose {FIRST.x} {FIRST.y} {FIRST.theta}"
POWER = "study power {plan} --score trust --factor dialogue.condition --people 4 --rehearsals 10 --processes 1"
LISTS = r"study/store/(exports|backups)\.json"
"""Lists of where exports and backups may lie, noted before anything is written there."""

KINDS = {
    # Recordings, and what is made of them
    "play": Kind(
        "play --headless --port 0 --max-seconds 1 --no-report --bag {disk}/new.bag",
        codes=(2, 1, 1),
        halves=RECORDING,
    ),
    "simr": Kind("simr --server 127.0.0.1:1 --bag {disk}/new.bag", codes=(2, 1, None)),
    "replay": Kind("replay {hunt} --to {disk}/new.bag", codes=(2, 1, 0), halves=RECORDING),
    "mavlink replay": Kind("mavlink replay {mavlink} --to {disk}/new.bag", halves=RECORDING),
    "report": Kind("report {bag} --to {disk}/new.html", older("new.html")),
    "bag cut": Kind("bag cut {bag} --overwrite --to {disk}/new.bag", older("new.bag")),
    "bag to-mcap": Kind("bag to-mcap {bag} --overwrite --to {disk}/new.mcap", older("new.mcap"), quick=True),
    "bag to-mcap, rosbag2": Kind("bag to-mcap {bag} --profile ros2 --to {disk}/new"),
    "bag export, parquet": Kind("bag export {bag} --format parquet --to {disk}/new"),
    "bag export, csv": Kind("bag export {bag} --format csv --to {disk}/new", quick=True),
    "bag plot": Kind("bag plot {drive} --what paths --to {disk}/new.svg", older("new.svg")),
    "bag reindex": Kind("bag reindex {disk}/new.bag.active", copied("bag", "new.bag.active"), quick=True),
    "localize, trajectory": Kind(f"{LOCALIZE} --out {{disk}}/new.tum", older("new.tum")),
    "localize, updates": Kind(f"{LOCALIZE} --updates {{disk}}/new.csv", older("new.csv")),
    "localize, picture": Kind(f"{LOCALIZE} --plot {{disk}}/new.png", older("new.png")),
    # Study files, maps, templates
    "study init": Kind("study init {disk}/new.yaml", quick=True),
    "maps check": Kind("maps check arena8 --to {disk}/new.png", older("new.png")),
    "maps new": Kind("maps new {drive_map} --no-times --to {disk}/new"),
    "maps measure": Kind("maps measure practice --runs 1 --jobs 1 --out {disk}/new"),
    "templates new": Kind("templates new {disk}/new", quick=True),
    # ROS, keys
    "ros messages": Kind("ros messages {disk}/new", quick=True),
    "ros rviz": Kind("ros rviz --to {disk}/new.rviz", older("new.rviz")),
    "ros foxglove": Kind("ros foxglove --to {disk}/new.json", older("new.json")),
    "keys new": Kind("keys new bob --keys {disk}/keys", with_key, told="/keys", quick=True),
    "keys revoke": Kind("keys revoke ada --keys {disk}/keys", with_key, told="/keys", quick=True),
    # Studies with people
    "study new": Kind("study new {disk}/new"),
    "study rehearse": Kind("study rehearse {plan} --no-games --to {disk}/new"),
    "study freeze": Kind("study freeze {disk}/new", copied("plan", "new")),
    "study export": Kind("study export {disk}/study --to {disk}/new", copied("rehearsed", "study"), left=LISTS),
    "study backup": Kind(
        "study backup {disk}/study --to {disk}/new", copied("rehearsed", "study"), left=LISTS, halves=RESUMED
    ),
    "study backup, again": Kind("study backup {disk}/study --to {disk}/new", with_backup),
    "study withdraw": Kind("study withdraw {disk}/new {person}", copied("rehearsed", "new")),
    "study power": Kind(f"{POWER} --to {{disk}}/new", codes=(1, 1, 0), halves=RESUMED),
    # Sweeps
    "sweep run": Kind("sweep run {design} --processes 1 --out {disk}/new", codes=(2, 1, 0), halves=RESUMED),
    "sweep collect, csv": Kind("sweep collect {sweep} --to {disk}/new.csv", older("new.csv")),
    "sweep collect, parquet": Kind("sweep collect {sweep} --to {disk}/new.parquet", older("new.parquet")),
    "sweep plot": Kind("sweep plot {sweep} --to {disk}/new.png", older("new.png")),
}


@pytest.fixture(scope="module")
def disk(tmp_path_factory: pytest.TempPathFactory) -> Iterator[SmallDisk]:
    if (reason := why_not()) is not None:
        pytest.skip(reason)
    with SmallDisk(tmp_path_factory.mktemp("small") / "disk", SIZE) as disk:
        yield disk


@pytest.fixture(scope="module")
def commands(tmp_path_factory: pytest.TempPathFactory) -> Commands:
    return Commands(tmp_path_factory.mktemp("said"))


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory, commands: Commands) -> Sources:
    return Sources(tmp_path_factory.mktemp("sources"), commands)


class Read:
    """Names of sources in words, made where they are wanted."""

    def __init__(self, sources: Sources, disk: Path) -> None:
        self._sources = sources
        self._disk = disk

    def __getitem__(self, name: str) -> str:
        return str(self._disk if name == "disk" else getattr(self._sources, name))


def refused(kind: Kind, ended: Ended, reason: str, code: int) -> None:
    """Fail unless a command has ended in one message."""
    assert "Traceback" not in ended.said, ended.said
    assert ended.code == code, ended.said
    lines = [line for line in ended.said.splitlines() if re.search(reason, line.lower())]
    assert len(lines) == 1, ended.said
    # The file, the reason, and as a sentence of its own what to do.
    assert re.search(rf"({kind.told}).*({reason}).*\. [A-Z].*\.$", lines[0], re.IGNORECASE), ended.said


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if kind.quick else pytest.mark.slow) for name, kind in KINDS.items()]
)
def test_what_cannot_be_written_is_told_and_nothing_is_lost(
    disk: SmallDisk, sources: Sources, commands: Commands, name: str
) -> None:
    kind = KINDS[name]
    words = [word.format_map(Read(sources, disk.folder)) for word in kind.words.split()]
    disk.empty()
    (disk.folder / "other").write_bytes(bytes(10_000))
    kind.prepare(disk.folder, sources)
    before, used = contents(disk.folder), disk.used

    def unchanged() -> None:
        now = contents(disk.folder)
        assert {path: now.get(path) for path in before} == before
        more = {path for path in now.keys() - before.keys() if now[path] is not None}
        assert {path for path in more if not re.fullmatch(kind.left, path)} == set()

    at_once, halfway, good = kind.codes
    with disk.read_only():
        refused(kind, commands.run(words, disk.folder), READ_ONLY, at_once)
    unchanged()
    with disk.full():
        refused(kind, commands.run(words, disk.folder), FULL, at_once)
    unchanged()
    if good is None:
        return
    done = commands.run(words, disk.folder)
    assert done.code == good, done.said
    written = disk.used - used
    for share in (0.5,) if kind.quick or kind.halves is Halves.RESUMED else (0.5, 0.1, 0.9):
        disk.empty()
        put(disk.folder, before)
        if (pages := int(written * share) // 4096) < 1:
            continue
        with disk.full(pages * 4096):
            refused(kind, commands.run(words, disk.folder), FULL, halfway)
        match kind.halves:
            case Halves.NOTHING:
                unchanged()
            case Halves.RECORDING:
                assert {path.name for path in disk.folder.glob("*.bag*")} == {"new.bag"}
                info(disk.folder / "new.bag")
            case Halves.RESUMED:
                assert [*disk.folder.rglob(f".*{PART}")] == []
                done = commands.run(words, disk.folder)
                assert done.code == good, done.said
