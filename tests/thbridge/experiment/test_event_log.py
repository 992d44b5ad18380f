"""The log of an experiment: whatever happens to its files, it is whole or says so."""

import itertools
import shutil
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from tests.support.studies.study_events import NOON, answer
from thbridge.experiment.store.event_log import BATCH, ExperimentLog, LogFollower, copy_log, read_log
from thbridge.experiment.store.events import WITHDRAWN, Clocks, LoggedEvent, NewEvent, Tombstone
from thbridge.files.errors import BadFile


def salts():
    """The same bytes in every run, none of them twice."""
    counter = itertools.count()
    return lambda size: next(counter).to_bytes(size, "big")


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """A log of six answers by two people, closed."""
    with ExperimentLog(tmp_path / "log", salts()) as log:
        for number in range(3):
            log.append([answer("P-AAAA", f"zebra {number}"), answer("P-BBBB", f"okapi {number}")])
    return tmp_path / "log"


def test_what_was_appended_is_read_in_its_order(log: Path) -> None:
    entries = read_log(log)
    assert [entry.sequence for entry in entries] == [1, 2, 3, 4, 5, 6]
    assert entries[1] == LoggedEvent(2, answer("P-BBBB", "okapi 0"))


def test_a_log_goes_on_where_it_ended(log: Path) -> None:
    with ExperimentLog(log) as again:
        assert [logged.sequence for logged in again.append([answer("P-AAAA", "later")])] == [7]
    assert read_log(log)[-1] == LoggedEvent(7, answer("P-AAAA", "later"))


def test_a_log_that_is_written_by_the_batch_is_the_same_to_the_byte(tmp_path: Path) -> None:
    events = [answer("P-AAAA", f"zebra {number}") for number in range(BATCH + 3)]
    for name, synced in (("synced", True), ("batches", False)):
        (tmp_path / name).mkdir()
        with ExperimentLog(tmp_path / name / "log", salts(), synced=synced) as log:
            for event in events:
                log.append([event])
            assert [entry.event for entry in log.read()] == events
            log.append([answer("P-AAAA", "the last word")])
    for file in ("log", "log-head"):
        assert (tmp_path / "synced" / file).read_bytes() == (tmp_path / "batches" / file).read_bytes()


def test_what_was_appended_is_there_although_the_program_was_killed(tmp_path: Path) -> None:
    program = (
        "import os, sys; from pathlib import Path; sys.path.insert(0, sys.argv[2])\n"
        "from tests.thbridge.experiment.test_event_log import *\n"
        "log = ExperimentLog(Path(sys.argv[1]))\n"
        "log.append([answer('P-AAAA', 'the last word')])\n"
        "os.kill(os.getpid(), 9)\n"
    )
    root = Path(__file__).parents[3]
    subprocess.run([sys.executable, "-c", program, str(tmp_path / "log"), str(root)], check=False)
    assert read_log(tmp_path / "log") == [LoggedEvent(1, answer("P-AAAA", "the last word"))]


def unnoticed(log: Path, history: list[object], spoilt: Path) -> bool:
    """True when a spoilt log reads as another history than that which was written."""
    try:
        read = read_log(spoilt)
    except BadFile:
        return False
    return read != history


def spoil(log: Path, folder: Path, name: str, content: bytes) -> Path:
    """A copy of the log whose file of this name has another content."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    for file in (log, log.with_name("log-head")):
        (folder / file.name).write_bytes(content if file.name == name else file.read_bytes())
    return folder / "log"


@pytest.mark.parametrize("name", ["log", "log-head"])
@pytest.mark.parametrize("stride", [17, pytest.param(1, marks=pytest.mark.slow)])
def test_a_flipped_byte_is_noticed_or_changes_nothing(log: Path, tmp_path: Path, name: str, stride: int) -> None:
    history, content = read_log(log), log.with_name(name).read_bytes()
    for place in range(0, len(content), stride):
        flipped = bytearray(content)
        flipped[place] ^= 0xFF if place % 2 else 0x01
        assert not unnoticed(log, history, spoil(log, tmp_path / "spoilt", name, bytes(flipped))), place


@pytest.mark.parametrize("name", ["log", "log-head"])
@pytest.mark.parametrize("stride", [61, pytest.param(1, marks=pytest.mark.slow)])
def test_a_log_cut_short_is_noticed(log: Path, tmp_path: Path, name: str, stride: int) -> None:
    history, content = read_log(log), log.with_name(name).read_bytes()
    for size in range(0, len(content), stride):
        assert not unnoticed(log, history, spoil(log, tmp_path / "spoilt", name, content[:size])), size


@pytest.mark.parametrize("stride", [211, pytest.param(1, marks=pytest.mark.slow)])
def test_a_write_ahead_log_cut_short_is_noticed(tmp_path: Path, stride: int) -> None:
    with ExperimentLog(tmp_path / "log", salts()) as log:
        log.append([answer("P-AAAA", "zebra")])
        log.append([answer("P-AAAA", "okapi")])
        files = {file.name: file.read_bytes() for file in tmp_path.iterdir() if not file.name.endswith("-shm")}
    history = read_log(tmp_path / "log")
    for size in range(0, len(files["log-wal"]), stride):
        spoilt = tmp_path / "spoilt"
        shutil.rmtree(spoilt, ignore_errors=True)
        spoilt.mkdir()
        for name, content in files.items():
            (spoilt / name).write_bytes(content[:size] if name == "log-wal" else content)
        assert not unnoticed(tmp_path / "log", history, spoilt / "log"), size


@pytest.mark.parametrize(
    "change",
    [
        "DELETE FROM events WHERE sequence = 6",
        "DELETE FROM events WHERE sequence = 3",
        "UPDATE events SET content = replace(content, 'zebra', 'horse') WHERE sequence = 3",
        "UPDATE events SET content = (SELECT content FROM events WHERE sequence = 1) WHERE sequence = 3",
        "UPDATE events SET content = NULL, salt = NULL WHERE sequence = 3",
        "INSERT INTO events SELECT 7, salt, content, digest, chain FROM events WHERE sequence = 6",
        "PRAGMA user_version = 2",
    ],
)
def test_a_changed_database_is_noticed(log: Path, change: str) -> None:
    with sqlite3.connect(log) as database:
        database.execute(change)
    database.close()
    with pytest.raises(BadFile):
        read_log(log)
    with pytest.raises(BadFile):
        ExperimentLog(log)


def test_somebody_who_withdraws_is_gone_from_all_files_and_the_rest_is_still_proved(log: Path) -> None:
    with ExperimentLog(log) as open_log:
        open_log.delete([1, 3, 5], NOON)
        inside = b"".join(file.read_bytes() for file in log.parent.iterdir())
        assert b"okapi" in inside
        assert b"zebra" not in inside
        assert b"P-AAAA" not in inside
        open_log.append([answer("P-BBBB", "afterwards")])
    entries = read_log(log)
    assert entries[0] == Tombstone(1)
    assert [entry.sequence for entry in entries if isinstance(entry, Tombstone)] == [1, 3, 5]
    assert entries[6].event.kind == WITHDRAWN
    assert b"zebra" not in log.read_bytes()


def test_a_backup_taken_while_the_log_is_open_reads_as_the_log(log: Path) -> None:
    with ExperimentLog(log) as open_log:
        open_log.append([answer("P-BBBB", "before the copy")])
        copy_log(log, log.with_name("copy"))
        open_log.append([answer("P-BBBB", "behind it")])
    assert read_log(log.with_name("copy")) == read_log(log)[:-1]


@pytest.fixture
def killed(tmp_path: Path) -> Path:
    """The log of a program that was killed: all but the first six events are in the write-ahead log alone."""
    folder = tmp_path / "killed"
    folder.mkdir()
    with ExperimentLog(tmp_path / "running") as log:
        log.append([answer("P-AAAA", f"zebra {number}") for number in range(6)])
    with ExperimentLog(tmp_path / "running") as log:
        copy_log(log.path, tmp_path / "backup")
        shutil.copy(log.path, tmp_path / "closed")
        shutil.copy(log.path.with_name("running-head"), tmp_path / "closed-head")
        log.append([answer("P-BBBB", f"okapi {number}") for number in range(3)])
        for suffix in ("", "-wal", "-head"):
            shutil.copy(tmp_path / f"running{suffix}", folder / f"log{suffix}")
    return folder / "log"


@pytest.mark.parametrize("copied", [("backup",), ("backup", "backup-head"), ("closed", "closed-head")])
@pytest.mark.parametrize("more", [0, 200])
def test_a_copy_over_the_log_of_a_killed_program_is_refused(
    killed: Path, tmp_path: Path, copied: tuple[str, ...], more: int
) -> None:
    if copied[0] == "closed":
        # A copy that somebody made by hand, of files that no program had open.
        with ExperimentLog(tmp_path / "closed") as log:
            log.append([answer("P-CCCC", f"quagga {number}") for number in range(more)])
    elif more:
        with ExperimentLog(tmp_path / "running") as log:
            log.append([answer("P-CCCC", f"quagga {number}") for number in range(more)])
        copy_log(tmp_path / "running", tmp_path / "backup")
    assert len(read_log(killed)) == 9
    for name in copied:
        shutil.copy(tmp_path / name, killed.parent / name.replace(copied[0], "log"))
    for opened in (read_log, ExperimentLog):
        with pytest.raises(BadFile, match=r"log-wal do not belong together.*thbridge study restore BACKUP --to"):
            opened(killed)


def test_the_files_of_a_log_belong_together_at_each_moment(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("thbridge.experiment.store.event_log.CHECKPOINT", 30_000)
    (tmp_path / "live").mkdir()
    sizes = []

    def look(log: ExperimentLog) -> None:
        """Look at a copy of its files, as they would be after a kill."""
        shutil.rmtree(tmp_path / "copy", ignore_errors=True)
        (tmp_path / "copy").mkdir()
        for name in ("log", "log-wal", "log-head"):
            shutil.copy(tmp_path / "live" / name, tmp_path / "copy" / name)
        history = log.read()
        assert read_log(tmp_path / "copy" / "log") == history
        with ExperimentLog(tmp_path / "copy" / "log") as again:
            assert again.read() == history
        sizes.append((tmp_path / "live" / "log-wal").stat().st_size)

    for restart in range(2):
        with ExperimentLog(tmp_path / "live" / "log") as log:
            for number in range(8):
                log.append([answer("P-AAAA", f"zebra {number}" * 50)])
                look(log)
                if number == 3:
                    # The last frames stay in the write-ahead log as long as somebody reads them.
                    reader = sqlite3.connect(tmp_path / "live" / "log")
                    reader.execute("BEGIN")
                    reader.execute("SELECT * FROM events").fetchone()
                if number == 5:
                    reader.close()
            log.delete([2 + restart], NOON)
    assert any(later < earlier for earlier, later in itertools.pairwise(sizes)), "there was no checkpoint"


def test_a_file_that_is_no_log_is_refused(tmp_path: Path) -> None:
    (tmp_path / "notes").write_text("dear diary")
    with pytest.raises(BadFile, match="not the log of an experiment"):
        read_log(tmp_path / "notes")
    with pytest.raises(BadFile):
        read_log(tmp_path / "nothing")


def test_a_follower_has_what_is_read_anew_after_each_append_and_deletion(tmp_path: Path) -> None:
    follower = LogFollower(tmp_path / "log")
    assert not follower.poll(), "there is no log yet"
    with ExperimentLog(tmp_path / "log") as log:
        for number in range(6):
            log.append([answer("P-AAAA", f"zebra {number}"), answer("P-BBBB", f"okapi {number}")])
            if number == 3:
                log.delete([2, 5], NOON)
            assert follower.poll()
            assert follower.entries == read_log(log.path)
            assert not follower.poll(), "nothing is new"


def test_a_follower_verifies_only_what_is_new(log: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    follower = LogFollower(log)
    follower.poll()
    with ExperimentLog(log) as again:
        again.append([answer("P-AAAA", "later")])
        monkeypatch.setattr("thbridge.experiment.store.event_log.read_log", lambda _: pytest.fail("all of it is read"))
        assert follower.poll()
    assert follower.entries[-1] == LoggedEvent(7, answer("P-AAAA", "later"))


def test_a_follower_tells_of_damage_once(log: Path) -> None:
    follower = LogFollower(log)
    follower.poll()
    known = follower.entries
    with ExperimentLog(log) as again:
        again.append([answer("P-AAAA", "later")])
    with sqlite3.connect(log) as database:
        database.execute("UPDATE events SET content = replace(content, 'later', 'never') WHERE sequence = 7")
    database.close()
    with pytest.raises(BadFile, match="event 7 was changed"):
        follower.poll()
    assert not follower.poll()
    assert follower.entries == known


def test_the_clock_of_other_recorders_is_kept(tmp_path: Path) -> None:
    stamped = NewEvent("note", "experimenter", Clocks("2026-01-02T12:00:00Z", 5, None, 46808.25), data={})
    with ExperimentLog(tmp_path / "log") as log:
        log.append([stamped, answer("P-AAAA", "later")])
    assert [entry.event.clocks.lsl for entry in read_log(tmp_path / "log")] == [46808.25, None]


def test_a_log_is_open_in_one_program_at_a_time(tmp_path: Path) -> None:
    with ExperimentLog(tmp_path / "log"), pytest.raises(BadFile, match="another program runs this study"):
        ExperimentLog(tmp_path / "log")
    ExperimentLog(tmp_path / "log").close()


def test_a_full_log_says_that_it_is_full_and_not_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("thbridge.experiment.store.event_log.LARGEST_LOG", 3 << 19)
    with ExperimentLog(tmp_path / "log", salts()) as log:
        with pytest.raises(BadFile) as refusal:
            for _ in range(100):
                log.append([answer("P-AAAA", "zebra " * 2000)])
        assert str(refusal.value).endswith(
            "/log: the log is full: a log has at most 1572864 bytes. "
            "End this study, and start another study in a new folder."
        )
        written = len(log.read())
        assert written > 10
        log.delete([1, 2], NOON)
        log.append([answer("P-BBBB", "okapi " * 2000)])
    assert len(read_log(tmp_path / "log")) == written + 2
