"""The power is cut in the middle of every single change that our writers make on a disk that forgets the rest.

Each writer says what it has promised; after each cut the disk is looked at as strictly as POSIX allows, and three times
more with some of what was not synced. Each says in `check` what has to be there.
"""

import functools
import multiprocessing
import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import msgspec
import pytest

from tests.support.bags.bags_with_faults import clean, write
from tests.support.disks.forgetting_disk import ForgettingDisk
from tests.support.hunts.game_states import EVENTS, STARTED
from tests.support.studies.participants import another_person, traces
from tests.support.studies.study_events import NOON, answer
from thbridge.analysis.cut import CutRange, cut
from thbridge.experiment.backup import back_up
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.restore import plan_restore, restore
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import LoggedEvent
from thbridge.experiment.withdrawal import finish_withdrawals, plan_withdrawal, withdraw
from thbridge.files.disk.whole import new_folder, write_whole
from thbridge.files.errors import BadFile
from thbridge.files.keys.certificate import certificate_of
from thbridge.files.keys.key_file import ClientKey, read_key
from thbridge.files.keys.key_ring import KeyRing, Right
from thbridge.mavlink.files.signing_timestamps import TimestampFile
from thbridge.mavlink.wire.frames.signing import KnownTimestamps
from thbridge.recording.bag.reading.reader import messages
from thbridge.recording.bag.repair import reindex
from thbridge.recording.journal import journal_path, read_journal
from thbridge.recording.journal_folder import JournalStore
from thbridge.recording.recordings import make_room

OUTCOMES = (None, 1, 2, 3)

Say = Callable[[object], None]


def nothing(_: Path) -> None:
    pass


@dataclass(frozen=True)
class Writer:
    """A writer with its promise.

    Attributes:
        act: writes into a folder of the disk, and says what it has promised.
        check: fails where what was said is not there, or what is there was never written.
        prepare: writes what was there long before.
    """

    act: Callable[[Path, Say], None]
    check: Callable[[Path, Sequence[object]], None]
    prepare: Callable[[Path], None] = nothing


WRITERS: dict[str, Writer] = {}


def a_file(write_one: Callable[[Path, bytes], None], name: str) -> None:
    """Enter a function that replaces files: each is one of the versions, and no older than the last one promised."""
    versions = [bytes([65 + number]) * size for number, size in enumerate((10, 40_000, 0, 3))]

    def act(folder: Path, say: Say) -> None:
        for number, version in enumerate(versions[1:], 1):
            write_one(folder / "file", version)
            say(number)
        write_one(folder / "another", versions[1])
        say("another")

    def check(folder: Path, said: Sequence[object]) -> None:
        there = (folder / "file").read_bytes()
        last = max([number for number in said if isinstance(number, int)], default=0)
        assert there in versions[last : last + 2]
        another = folder / "another"
        assert another.exists() or "another" not in said
        assert not another.exists() or another.read_bytes() == versions[1]

    WRITERS[name] = Writer(act, check, lambda folder: write_one(folder / "file", versions[0]))


a_file(write_whole, "whole file")


def fill_folder(folder: Path, say: Say) -> None:
    with new_folder(folder / "above" / "new") as new:
        (new / "inside").mkdir()
        for path in (new / "inside" / "one", new / "two"):
            path.write_bytes(bytes(5000))
    say(1)


def check_folder(folder: Path, said: Sequence[object]) -> None:
    new = folder / "above" / "new"
    assert new.exists() or not said
    if new.exists():
        assert [(new / name).read_bytes() for name in ("inside/one", "two")] == [bytes(5000)] * 2


WRITERS["new folder"] = Writer(fill_folder, check_folder)


def keys(folder: Path) -> KeyRing:
    return KeyRing(folder / "keys", lambda: "2026-01-02T12:00:00Z")


def make_keys(folder: Path, say: Say) -> None:
    for name in ("ada", "bob"):
        keys(folder).add(name, [Right.WATCH], f"secret of {name}", None)
        say(f"new {name}")
    keys(folder).revoke("ada")
    say("revoked ada")


def check_keys(folder: Path, said: Sequence[object]) -> None:
    ring = keys(folder)
    entries = {entry.name: entry for entry in ring.entries}
    for name in ("ada", "bob"):
        if f"new {name}" in said or name in entries:
            assert isinstance(ring.holder(f"secret of {name}"), str) == (entries[name].revoked is not None)
            fingerprint = certificate_of(folder / "keys", "2026-01-03T12:00:00Z").fingerprint
            assert read_key(folder / "keys" / f"{name}.key") == ClientKey(f"secret of {name}", fingerprint)
    if "revoked ada" in said:
        assert entries["ada"].revoked
    # A name whose making was cut off can be taken again; a file that is left over is never overwritten.
    for name in {"ada", "bob"} - set(entries):
        if (left := folder / "keys" / f"{name}.key").exists():
            with pytest.raises(BadFile, match="Move the file to another"):
                ring.add(name, [Right.WATCH], "another secret", None)
            left.unlink()
        ring.add(name, [Right.WATCH], "another secret", None)


WRITERS["key ring"] = Writer(make_keys, check_keys)


def tell_timestamps(folder: Path, say: Say) -> None:
    for latest in (10, 20, 30):
        TimestampFile(folder / "key").write(KnownTimestamps(latest, {(0, 1, 1): latest}))
        say(latest)


def check_timestamps(folder: Path, said: Sequence[object]) -> None:
    known = TimestampFile(folder / "key").read()
    assert known is not None or not said
    assert known is None or (known.latest >= max(said, default=0) and known.streams == {(0, 1, 1): known.latest})


WRITERS["signing timestamps"] = Writer(tell_timestamps, check_timestamps)

GAMES = [(number, msgspec.structs.replace(STARTED, game=number), EVENTS) for number in (1, 2)]


def play_games(folder: Path, say: Say) -> None:
    store = JournalStore(folder / "new" / "journal")
    for number, started, events in GAMES:
        for count, event in enumerate((started, *events)):
            store.append([event])
            say((number, count))


def check_games(folder: Path, said: Sequence[tuple[int, int]]) -> None:
    journals = folder / "new" / "journal"
    for number, started, events in GAMES:
        counts = [count for game, count in said if game == number]
        if counts:
            found = read_journal(journal_path(journals, number))
            assert found.started == started
            assert found.events == events[: len(found.events)]
            assert len(found.events) >= max(counts)
    # The server goes on with the last game, or with the next.
    store = JournalStore(journals)
    if store.resume() is None:
        store.append([msgspec.structs.replace(STARTED, game=store.last_game + 1)])
    store.close()


WRITERS["journal"] = Writer(play_games, check_games)


def answers(folder: Path, say: Say) -> None:
    with ExperimentLog(folder / "log") as log:
        say("open")
        for number in range(3):
            log.append([answer("P-AAAA", f"zebra {number}"), answer("P-BBBB", f"okapi {number}")])
            say(f"{number}")
        log.delete([1], NOON)
        say("deleted")


def check_answers(folder: Path, said: Sequence[object]) -> None:
    with ExperimentLog(folder / "log") as log:
        events = [entry.event for entry in log.read() if isinstance(entry, LoggedEvent)]
    texts = [str(event.data["text"]) for event in events if event.data and "text" in event.data]
    for number in range(3):
        if f"{number}" in said:
            assert f"okapi {number}" in texts
        assert (f"okapi {number}" in texts) == (f"zebra {number}" in texts) or (number == 0 and "2" in said)
    if "deleted" in said:
        assert b"zebra 0" not in (folder / "log").read_bytes()


WRITERS["log of an experiment"] = Writer(answers, check_answers)


def prepare_study(folder: Path) -> None:
    (folder / "study" / "data" / "recordings" / "P-AAAA").mkdir(parents=True)
    (folder / "study" / "experiment.yaml").write_text("title: zebras\n" * 100)
    study = ExperimentFolder(folder / "study")
    study.log.parent.mkdir(parents=True, exist_ok=True)
    with ExperimentLog(study.log) as log:
        log.append([answer("P-AAAA", "zebra")])


def keep_copies(folder: Path, say: Say) -> None:
    study = ExperimentFolder(folder / "study")
    back_up(study, folder / "copies" / "copy")
    say(1)
    with ExperimentLog(study.log) as log:
        log.append([answer("P-AAAA", "okapi")])
    study.file.write_bytes(b"title: okapis\n" * 200)
    back_up(study, folder / "copies" / "copy")
    say(2)


def check_copies(folder: Path, said: Sequence[object]) -> None:
    copy = ExperimentFolder(folder / "copies" / "copy")
    if said:
        assert len(read_log(copy.log)) >= len(said)
        design = copy.file.read_bytes()
        assert design == b"title: okapis\n" * 200 or (len(said) < 2 and design == b"title: zebras\n" * 100)
    study = ExperimentFolder(folder / "study")
    study.file.write_bytes(b"title: quaggas\n")
    back_up(study, folder / "copies" / "copy")
    assert copy.file.read_bytes() == b"title: quaggas\n"
    assert len(read_log(copy.log)) == len(read_log(study.log))


WRITERS["backup of a study"] = Writer(keep_copies, check_copies, prepare_study)


@functools.cache
def participants() -> tuple[Path, str]:
    """A study in which two people took part, and the id of the first."""
    root = Path(tempfile.mkdtemp()) / "study"
    root.mkdir()
    first = another_person(root, "I like okapis")
    another_person(root, "I saw a zebra")
    return root, first


def prepare_people(folder: Path) -> None:
    shutil.copytree(participants()[0], folder / "study")
    back_up(ExperimentFolder(folder / "study"), folder / "copy")


def leave(folder: Path, say: Say) -> None:
    study = ExperimentFolder(folder / "study")
    design = study.read()
    first = next(entry.event.participant for entry in study.entries() if isinstance(entry, LoggedEvent))
    told = withdraw(study, design, plan_withdrawal(study, design, first).withdrawal, {}, None, lambda: NOON)
    assert not told.failed
    say(1)


def check_left(folder: Path, said: Sequence[object]) -> None:
    study, first = ExperimentFolder(folder / "study"), participants()[1]
    if not said:
        finish_withdrawals(study, study.read(), {}, None, lambda: NOON)
    people = {entry.event.participant for entry in study.entries() if isinstance(entry, LoggedEvent)}
    if first in people and not said:
        # Nothing was deleted before the intention was on the disk.
        assert (study.recordings / first / "step-9.bag").exists()
        assert read_log(folder / "copy" / "store" / "log") == study.entries()
        return
    assert traces(folder, [first, "I like okapis"]) == []
    assert read_log(folder / "copy" / "store" / "log") == study.entries()


WRITERS["withdrawal"] = Writer(leave, check_left, prepare_people)


def prepare_newer(folder: Path) -> None:
    prepare_people(folder)
    study = ExperimentFolder(folder / "study")
    with ExperimentLog(study.log) as log:
        log.append([answer("", "the last word", step=0)])
    (study.root / "consent.txt").write_bytes(b"Another text.")


def go_back(folder: Path, say: Say) -> None:
    restore(plan_restore(folder / "copy", folder / "study"))
    say(1)


def check_back(folder: Path, said: Sequence[object]) -> None:
    study, copy = ExperimentFolder(folder / "study"), ExperimentFolder(folder / "copy")
    try:
        whole = len(study.entries())
    except BadFile:
        assert not said
        whole = 0
    assert whole in ({len(copy.entries())} if said else {0, len(copy.entries()), len(copy.entries()) + 1})
    restore(plan_restore(copy.root, study.root))
    assert study.entries() == copy.entries()
    assert (study.root / "consent.txt").read_bytes() != b"Another text."
    kept = [each for each in study.replaced() if (each.root / "consent.txt").read_bytes() == b"Another text."]
    assert len(kept[0].entries()) == len(copy.entries()) + 1


WRITERS["restore of a study"] = Writer(go_back, check_back, prepare_newer)


def prepare_bag(folder: Path) -> None:
    write(folder / "a.bag", clean())


def cut_bag(folder: Path, say: Say) -> None:
    for number in (1, 2):
        cut(folder / "a.bag", CutRange(), folder / "piece.bag", overwrite=number == 2)
        say(number)


def check_piece(folder: Path, said: Sequence[object]) -> None:
    piece = folder / "piece.bag"
    assert piece.exists() or not said
    if piece.exists():
        assert len(list(messages(piece))) == len(list(messages(folder / "a.bag")))


WRITERS["bag cut"] = Writer(cut_bag, check_piece, prepare_bag)


def prepare_active(folder: Path) -> None:
    write(folder / "a.bag", clean())
    (folder / "whole.bag").write_bytes((folder / "a.bag").read_bytes())
    (folder / "a.bag").rename(folder / "a.bag.active")


def mend(folder: Path, say: Say) -> None:
    reindex(folder / "a.bag.active")
    say(1)


def check_mended(folder: Path, said: Sequence[object]) -> None:
    whole = [message.data for message in messages(folder / "whole.bag")]
    if said or (folder / "a.bag").exists():
        assert [message.data for message in messages(folder / "a.bag")] == whole
    if not said and (folder / "a.bag.active").exists() and not (folder / "a.bag").exists():
        reindex(folder / "a.bag.active")
    assert [message.data for message in messages(folder / "a.bag")] == whole


WRITERS["bag reindex"] = Writer(mend, check_mended, prepare_active)


def prepare_older(folder: Path) -> None:
    (folder / "a.bag").write_bytes(b"older")
    (folder / "a.journal").mkdir()
    (folder / "a.journal" / "game-0001.jsonl").write_bytes(b"older journal")


def move_older(folder: Path, say: Say) -> None:
    say(str(make_room(folder / "a.bag")))
    (folder / "a.bag").write_bytes(b"newer")
    JournalStore(folder / "a.journal")


def check_older(folder: Path, said: Sequence[object]) -> None:
    bags = {path.name: path.read_bytes() for path in folder.glob("*.bag")}
    assert list(bags.values()).count(b"older") == 1
    assert bags.get("a-1.bag") == b"older" or not said
    journals = [path.parent.name for path in folder.glob("*.journal/game-0001.jsonl")]
    assert len(journals) == 1
    assert journals == ["a-1.journal"] or not said


WRITERS["older recording"] = Writer(move_older, check_older, prepare_older)

QUICK = {"whole file", "journal", "older recording"}
"""Writers of every kind of promise, with few changes; others take ten seconds and more, or write as one of these."""


def run(name: str, folder: Path, to: Connection) -> None:
    """Let a writer write, in a process of its own."""
    WRITERS[name].act(folder, to.send)
    to.send(None)


@pytest.fixture(scope="module")
def processes() -> multiprocessing.context.BaseContext:
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    return context


def test_the_disk_forgets_what_was_not_synced(disk: ForgettingDisk) -> None:
    disk.fresh()
    (disk.folder / "file").write_bytes(b"old")
    disk.settle()
    (disk.folder / "new").write_bytes(b"new")
    (disk.folder / "new").rename(disk.folder / "file")
    disk.cut()
    assert (disk.folder / "file").read_bytes() == b"old"
    found = set()
    for seed in range(50):
        disk.cut(seed=seed)
        found.add((disk.folder / "file").read_bytes())
    # Renamed, and its bytes were not synced.
    assert {b"old", b"new", b""} <= found


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow, pytest.mark.timeout(3600)] if name not in QUICK else ())
        for name in WRITERS
    ],
)
def test_what_was_promised_is_there_after_a_power_cut_at_any_change(
    disk: ForgettingDisk, processes: multiprocessing.context.BaseContext, name: str
) -> None:
    writer, change, stopped = WRITERS[name], 0, True
    while stopped:
        change += 1
        disk.fresh()
        writer.prepare(disk.folder)
        disk.settle()
        ours, theirs = processes.Pipe(duplex=False)
        disk.cut_after(change)
        process = processes.Process(target=run, args=(name, disk.folder, theirs))
        process.start()
        theirs.close()
        stopped = disk.wait(process)
        said: list[object] = []
        if not stopped:
            process.join()
        for number, outcome in enumerate(OUTCOMES):
            disk.cut(*([process] if number == 0 and stopped else []), seed=outcome)
            if number == 0:
                process.join()
                while ours.poll():
                    try:
                        said.append(ours.recv())
                    except EOFError:
                        break
            promised = [each for each in said if each is not None]
            try:
                writer.check(disk.folder, promised)
            except Exception as fault:
                raise AssertionError(f"change {change}, outcome {outcome}, after {promised}: {fault!r}") from fault
        ours.close()
    assert said[-1] is None, "the writer has failed without a power cut"
    assert change > 3
