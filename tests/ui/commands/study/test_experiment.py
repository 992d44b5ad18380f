"""A study with people by commands alone: begun, checked, frozen, rehearsed, exported, and somebody withdraws."""

import json
from pathlib import Path

import pandas as pd
import pytest

from tests.support.programs.commands import invoke, output_of
from thbridge.experiment.store.event_log import ExperimentLog


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    output_of("study", "new", tmp_path / "arguing")
    file = tmp_path / "arguing" / "experiment.yaml"
    file.write_text(file.read_text().replace("quota: 24", "quota: 4"))
    return tmp_path / "arguing"


def test_from_a_new_study_to_its_tables(folder: Path, tmp_path: Path) -> None:
    assert "no faults; 4 people, 2 conditions for each" in output_of("study", "check", folder)
    digest = output_of("study", "freeze", folder).splitlines()[0]
    assert len(digest) == 64
    said = output_of("study", "rehearse", folder, "--to", tmp_path / "rehearsal", "--no-games")
    assert "4 of 4 runs complete" in said
    assert "The study is frozen, and unchanged since then." in said
    output_of("study", "export", tmp_path / "rehearsal", "--to", tmp_path / "tables")
    people = pd.read_parquet(tmp_path / "tables" / "tables" / "participants.parquet")
    assert (people.state == "complete").sum() == 4
    assert "has not changed since it was frozen" in (tmp_path / "tables" / "CHANGES.md").read_text()


def test_a_new_study_may_be_in_german(tmp_path: Path) -> None:
    output_of("study", "new", tmp_path / "streit", "--language", "de")
    said = output_of("study", "check", tmp_path / "streit")
    assert "no faults; 24 people" in said and "language" not in said and "translation" not in said
    assert (tmp_path / "streit" / "texts" / "welcome.txt").read_text().startswith("Willkommen.")
    done = invoke("study", "new", tmp_path / "nl", "--language", "nl")
    assert (done.exit_code, (tmp_path / "nl").exists()) == (2, False)
    assert "--language: there is no example in nl. Choose one of en, de;" in done.stderr


def test_a_quota_that_leaves_orders_uneven_is_told(folder: Path) -> None:
    file = folder / "experiment.yaml"
    assert "some orders occur more often" not in output_of("study", "check", folder)
    file.write_text(file.read_text().replace("quota: 4", "quota: 3"))
    assert "some orders occur more often" in output_of("study", "check", folder)


def test_nothing_is_left_of_somebody_who_withdraws(folder: Path, tmp_path: Path) -> None:
    output_of("study", "rehearse", folder, "--to", tmp_path / "rehearsal", "--no-games")
    status = output_of("study", "status", tmp_path / "rehearsal")
    gone = next(word for word in status.split() if word.startswith("P-"))
    recording = tmp_path / "rehearsal" / "recordings" / gone / "step-5.bag"
    recording.parent.mkdir(parents=True)
    recording.write_bytes(b"a game")
    output_of("study", "withdraw", tmp_path / "rehearsal", gone, "--yes")
    assert gone not in output_of("study", "status", tmp_path / "rehearsal")
    for file in (tmp_path / "rehearsal").rglob("*"):
        assert gone not in file.name
        assert not file.is_file() or gone.encode() not in file.read_bytes()
    told = json.loads(output_of("study", "status", tmp_path / "rehearsal", "--json"))
    assert told["planned"] == 4


@pytest.mark.parametrize(
    ("arguments", "problem"),
    [
        (("check",), "the folder has no experiment.yaml"),
        (("status",), "the folder has no experiment.yaml"),
        (("freeze",), "the folder has no experiment.yaml"),
        (("rehearse", "--to", "x"), "the folder has no experiment.yaml"),
        (("export", "--to", "x"), "the folder has no experiment.yaml"),
        (("run",), "the folder has no experiment.yaml"),
    ],
)
def test_a_folder_that_is_no_experiment(tmp_path: Path, arguments: tuple[str, ...], problem: str) -> None:
    command, *options = arguments
    done = invoke("study", command, tmp_path, *options)
    assert done.exit_code == 2
    assert problem in done.output


@pytest.mark.parametrize("options", [("check",), ("freeze",), ("rehearse", "--to", "x"), ("run",)])
def test_files_that_a_game_lacks_are_told_before_anybody_comes(folder: Path, options: tuple[str, ...]) -> None:
    file = folder / "experiment.yaml"
    file.write_text(file.read_text().replace("  robots: 2\n", "  robots: 2\n  map: nowhere\n"))
    command, *rest = options
    done = invoke("study", command, folder, *rest)
    assert done.exit_code == 2
    # Line 4 begins the section `base`.
    assert f"{file}, line 4, map: no map has this name" in " ".join(done.output.split())


def test_somebody_who_never_took_part_cannot_withdraw(folder: Path, tmp_path: Path) -> None:
    output_of("study", "rehearse", folder, "--to", tmp_path / "rehearsal", "--no-games")
    done = invoke("study", "withdraw", tmp_path / "rehearsal", "P-NOBODY", "--yes")
    assert done.exit_code == 2
    assert "no data of a participant with this id" in " ".join(done.output.split())


def test_a_study_is_not_run_without_a_display_or_twice(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("QT_QPA_PLATFORM", "offscreen")
    done = invoke("study", "run", folder)
    assert done.exit_code == 2
    assert "prevents visible windows" in done.output
    monkeypatch.setenv("QT_QPA_PLATFORM", "xcb")
    (folder / "store").mkdir()
    with ExperimentLog(folder / "store" / "log"):
        done = invoke("study", "run", folder)
    assert done.exit_code == 2
    assert "another program runs this study" in done.output


@pytest.mark.parametrize("name", ["texts/consent.txt", "understood.yaml"])
@pytest.mark.parametrize(("encoding", "told"), [("cp1252", "Windows-1252"), ("utf-16", "UTF-16")])
def test_a_text_in_another_encoding_is_refused_by_the_check(folder: Path, name: str, encoding: str, told: str) -> None:
    file = folder / name
    file.write_bytes(file.read_text().replace("\n", " “quoted”\n", 1).encode(encoding))
    checked = invoke("study", "check", folder)
    assert checked.exit_code == 2
    assert isinstance(checked.exception, SystemExit)
    assert f"{file.name}, line 1: " in checked.output
    assert f"the file was probably saved as {told}. Save the file with the encoding UTF-8" in checked.output
