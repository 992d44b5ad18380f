"""A study is restored from a backup: nothing that it had is lost, and who withdrew since stays withdrawn."""

import shutil
from pathlib import Path

import pytest

from tests.support.programs.commands import invoke, output_of, refusal_of
from tests.support.studies.participants import another_person, people, traces
from tests.support.studies.study_events import answer
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Tombstone


@pytest.fixture
def study(tmp_path: Path) -> Path:
    """A study with two participants, and `backup` beside it."""
    root = tmp_path / "study"
    root.mkdir()
    for why in ("I like okapis", "I saw a zebra"):
        another_person(root, why)
    output_of("study", "backup", root, "--to", tmp_path / "backup")
    return root


def kill(study: Path, tmp_path: Path) -> None:
    """Leave a study as a program does that is killed after it has appended an event."""
    with ExperimentLog(study / "store" / "log") as log:
        log.append([answer("", "the last word", step=0)])
        shutil.copytree(study / "store", tmp_path / "killed")
    shutil.rmtree(study / "store")
    (tmp_path / "killed").rename(study / "store")


def test_a_killed_study_is_restored_and_what_it_had_is_kept(study: Path, tmp_path: Path) -> None:
    third = another_person(study, "an ibis")
    kill(study, tmp_path)
    shutil.copy(tmp_path / "backup" / "store" / "log", study / "store" / "log")
    assert "do not belong together" in refusal_of("study", "status", study)
    said = output_of("study", "restore", tmp_path / "backup")
    assert read_log(study / "store" / "log") == read_log(tmp_path / "backup" / "store" / "log")
    assert len(people(study)) == 2
    kept = study / "store" / "replaced-1"
    assert f"are kept in {kept}" in " ".join(said.split())
    # The write-ahead log has what the overwritten one had not.
    assert b"the last word" in (kept / "store" / "log-wal").read_bytes()
    assert (kept / "recordings" / third / "step-9.bag").exists()
    assert not (study / "recordings" / third).exists()
    assert another_person(study, "somebody else") in people(study)


def test_a_whole_newer_study_is_replaced_only_if_somebody_says_so(study: Path, tmp_path: Path) -> None:
    third = another_person(study, "an ibis")
    (study / "consent.txt").write_text("Another text.\n")
    before = read_log(study / "store" / "log")
    said = refusal_of("study", "restore", tmp_path / "backup", "--to", study)
    assert "is intact, and has" in said
    assert "Nothing was restored" in said
    assert read_log(study / "store" / "log") == before
    output_of("study", "restore", tmp_path / "backup", "--to", study, "--yes")
    assert len(people(study)) == 2
    kept = study / "store" / "replaced-1"
    assert read_log(kept / "store" / "log") == before
    assert (kept / "consent.txt").read_text() == "Another text.\n"
    assert (study / "consent.txt").read_text() != "Another text.\n"
    assert third in people(kept)
    # Who is known there alone can withdraw.
    output_of("study", "withdraw", study, third, "--yes")
    assert traces(tmp_path, [third, "an ibis"]) == []


@pytest.mark.parametrize("damaged", [False, True])
def test_who_withdrew_after_the_backup_stays_withdrawn(study: Path, tmp_path: Path, damaged: bool) -> None:
    gone, other = people(study)
    # A copy that the study does not know of.
    shutil.copytree(tmp_path / "backup", tmp_path / "tape")
    output_of("study", "withdraw", study, gone, "--yes")
    if damaged:
        (study / "store" / "log").write_bytes(b"nothing")
    assert traces(tmp_path / "tape", [gone, "I like okapis"])
    output_of("study", "restore", tmp_path / "tape", "--to", study, "--yes")
    assert people(study) == [other]
    # The copy is known now.
    assert traces(tmp_path, [gone, "I like okapis"]) == []
    assert any(isinstance(entry, Tombstone) for entry in read_log(study / "store" / "log"))


def test_a_lost_study_comes_back_and_knows_its_backup(study: Path, tmp_path: Path) -> None:
    first, second = people(study)
    shutil.rmtree(study)
    output_of("study", "restore", tmp_path / "backup")
    assert people(study) == [first, second]
    assert (study / "recordings" / first / "step-9.bag").read_bytes() == f"a game of {first}".encode()
    assert not list(study.glob("store/replaced-*"))
    output_of("study", "withdraw", study, first, "--yes")
    assert traces(tmp_path, [first, "I like okapis"]) == []


def test_a_restore_is_refused_where_it_would_do_harm(study: Path, tmp_path: Path) -> None:
    backup = tmp_path / "backup"
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "one.jpg").write_bytes(b"x")
    assert "do not belong to a study" in refusal_of("study", "restore", backup, "--to", tmp_path / "photos")
    assert "inside the other" in refusal_of("study", "restore", backup, "--to", backup / "study")
    assert "not a backup of a study" in refusal_of("study", "restore", tmp_path / "photos", "--to", study)
    with ExperimentLog(study / "store" / "log"):
        assert "another program runs this study" in refusal_of("study", "restore", backup, "--to", study)
    (backup / "store" / "log").write_bytes(b"nothing")
    assert "is damaged" in refusal_of("study", "restore", backup, "--to", study)
    assert len(people(study)) == 2
    assert invoke("study", "restore", tmp_path / "nothing").exit_code == 2
