"""Somebody who took part at the kiosk withdraws, and nothing of them is left wherever the study has data."""

import json
import random
import shutil
from pathlib import Path

import pandas as pd
import pytest

from tests.support.programs.commands import invoke, output_of, refusal_of
from tests.support.studies.kiosk_without_screen import Laboratory, Person
from tests.support.studies.participants import people, traces
from tests.support.studies.study_events import NOON
from thbridge.experiment.conductor import Conductor, sequences_of
from thbridge.experiment.export.manifest import manifest_text
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Tombstone
from thbridge.experiment.withdrawal import plan_withdrawal
from ui.hosting.kiosk.games import StudyGames

STUDY = """\
title: A small study
base: {map: practice, templates: practice, robots: 1, rate: 50, server.port: 0}
quota: 3
recruiting: {ask: Which code?}
steps:
  - {step: consent, text: consent.txt}
  - {step: trial, name: first, max_seconds: 2}
  - {step: form, form: final.yaml, name: final}
"""
CODES, WORDS = ("service-okapi", "service-zebra", "service-ibis"), ("I like okapis", "I saw a zebra", "ibis, ibis")


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A study in which three people took part, with games that were recorded."""
    root = tmp_path_factory.mktemp("finished") / "study"
    root.mkdir()
    laboratory = Laboratory(root, STUDY)
    laboratory.games = StudyGames(ExperimentFolder(root), laboratory.design)
    for code, why in zip(CODES, WORDS, strict=True):
        laboratory.run(Person({"code": code, "why": why}))
    return root


@pytest.fixture
def study(finished: Path, tmp_path: Path) -> Path:
    shutil.copytree(finished, tmp_path / "study")
    return tmp_path / "study"


def rows(export: Path, without: str) -> dict[str, pd.DataFrame]:
    read = {path.stem: pd.read_parquet(path) for path in (export / "tables").iterdir()}
    return {name: table[table.participant != without].reset_index(drop=True) for name, table in read.items()}


def test_nothing_is_left_of_who_withdraws_and_all_that_is_of_others(study: Path, tmp_path: Path) -> None:
    inside, outside, backup = study / "exports" / "one", tmp_path / "two", tmp_path / "backup"
    _, gone, _ = people(study)
    with ExperimentLog(study / "store" / "log"):
        # It is in use.
        output_of("study", "backup", study, "--to", backup)
    for export in (inside, outside):
        output_of("study", "export", study, "--to", export)
    (outside / "analysis.py").write_text("# mine\n")
    (outside / "results").mkdir()
    (outside / "results" / "cells.csv").write_text(f"{gone},1\n")
    (outside / "mine.txt").write_text("my own notes\n")
    (outside / "notes").mkdir()
    (outside / "notes" / "people.txt").write_text(f"{gone} was in a hurry\n")
    words = [gone, CODES[1], WORDS[1]]
    for root, wanted in ((study, 3), (outside, 2), (backup, 3)):
        found = traces(root, words)
        assert len({each.split(" in /")[0] for each in found}) == wanted, found
    others = [rows(export, gone) for export in (inside, outside)]
    # Left by a withdrawal that was killed while it wrote this list.
    (study / "store" / ".withdrawal.json.0badcafe.part").write_text(gone)
    first, *_ = people(study)
    for participant in (first, gone):
        ExperimentFolder(study).tickets.keep(f"secret of {participant}", participant)

    said = " ".join(output_of("study", "withdraw", study, gone, "--yes").split())

    assert f"{outside / 'notes' / 'people.txt'} does not belong to the export and names {gone}. Delete" in said
    (outside / "notes" / "people.txt").unlink()
    assert traces(tmp_path, words) == []
    for export, before in zip((inside, outside), others, strict=True):
        after = rows(export, "")
        assert before.keys() == after.keys()
        for name, table in after.items():
            pd.testing.assert_frame_equal(table, before[name])
        assert f"{export}: this export was written again, without {gone}" in said
    assert ExperimentFolder(study).tickets.participant(f"secret of {first}") == first
    assert (outside / "analysis.py").read_text() == "# mine\n"
    assert f"{outside / 'mine.txt'} does not belong to the export" in said
    assert f"{backup}: this backup was updated and has" in said
    for place in (study, backup):
        entries = read_log(place / "store" / "log")
        assert any(isinstance(entry, Tombstone) for entry in entries)
        assert len(people(place)) == 2
    assert "has no data of a participant" in refusal_of("study", "withdraw", study, gone, "--yes")


def test_an_older_copy_of_a_study_leaves_exports_alone_that_know_more(finished: Path, tmp_path: Path) -> None:
    shutil.copytree(finished, tmp_path / "older")
    log = tmp_path / "older" / "store" / "log"
    shutil.copytree(finished, tmp_path / "newer")
    newer, outside = tmp_path / "newer", tmp_path / "out"
    output_of("study", "export", newer, "--to", outside)
    manifest = outside / "manifest.json"
    told = json.loads(manifest.read_text())
    manifest.write_text(manifest_text(told["title"], told["participants"], told["events"] + 3))
    shutil.copy(newer / "store" / "exports.json", log.parent / "exports.json")
    before = {path: path.read_bytes() for path in outside.rglob("*") if path.is_file()}
    _, gone, _ = people(tmp_path / "older")
    said = refusal_of("study", "withdraw", tmp_path / "older", gone, "--yes")
    assert f"this study is an older copy. The export still has data of {gone}" in said
    assert {path: path.read_bytes() for path in outside.rglob("*") if path.is_file()} == before


def test_somebody_who_knows_their_completion_code_alone_can_withdraw(study: Path) -> None:
    folder = ExperimentFolder(study)
    first, *others = people(study)
    code = next(
        entry.event.data["code"]
        for entry in folder.entries()
        if not isinstance(entry, Tombstone) and entry.event.kind == "run-ended" and entry.event.participant == first
    )
    # As the last page shows it, and a shell takes it apart.
    output_of("study", "withdraw", study, code[:4], code[4:].lower(), "--yes")
    assert people(study) == others
    output_of("study", "withdraw", study, others[0].lower(), "--yes")
    assert people(study) == others[1:]


def test_what_is_not_there_is_done_by_the_next_command_once_it_is(study: Path, tmp_path: Path) -> None:
    export, backup, away = tmp_path / "export", tmp_path / "backup", tmp_path / "away"
    first, *_ = people(study)
    output_of("study", "export", study, "--to", export)
    output_of("study", "backup", study, "--to", backup)
    away.mkdir()
    for each in (export, backup):
        each.rename(away / each.name)
    for command in ("withdraw", "withdraw"):
        said = refusal_of("study", command, study, first, "--yes")
        assert f"{export}: an export was written here, but this folder no longer exists" in said
        assert f"{backup}: a backup was written here, but this folder no longer exists" in said
        assert f"The withdrawal of {first} is not finished" in said
    for each in (export, backup):
        (away / each.name).rename(each)
    assert f"The interrupted withdrawal of {first} is finished" in output_of("study", "status", study)
    assert traces(tmp_path, [first, CODES[0], WORDS[0]]) == []
    assert "interrupted" not in output_of("study", "status", study)


def test_an_export_that_no_longer_exists_is_forgotten_if_somebody_says_so(study: Path, tmp_path: Path) -> None:
    first, *_ = people(study)
    export = tmp_path / "export"
    output_of("study", "export", study, "--to", export)
    assert "this folder exists" in refusal_of("study", "withdraw", study, "--gone", export)
    assert "was written there" in refusal_of("study", "withdraw", study, "--gone", tmp_path / "other")
    shutil.rmtree(export)
    refusal_of("study", "withdraw", study, first, "--yes")
    assert f"interrupted withdrawal of {first} is finished" in output_of("study", "withdraw", study, "--gone", export)
    assert traces(tmp_path, [first, CODES[0], WORDS[0]]) == []


@pytest.mark.parametrize("inside", [False, True])
def test_what_a_killed_export_has_left_is_deleted(study: Path, tmp_path: Path, inside: bool) -> None:
    first, *_ = people(study)
    export = study / "exports" / "one" if inside else tmp_path / "export"
    output_of("study", "export", study, "--to", export)
    part = export / ".all.0a1b2c3d.part"
    part.mkdir()
    for path in [path for path in export.iterdir() if path != part]:
        path.rename(part / path.name)
    assert traces(export, [first])
    output_of("study", "withdraw", study, first, "--yes")
    assert traces(tmp_path, [first, CODES[0], WORDS[0]]) == []


def test_a_backup_in_use_is_done_by_the_next_command(study: Path, tmp_path: Path) -> None:
    backup, (first, *_) = tmp_path / "backup", people(study)
    output_of("study", "backup", study, "--to", backup)
    with ExperimentLog(backup / "store" / "log"):
        assert "another program runs this study" in refusal_of("study", "withdraw", study, first, "--yes")
    assert traces(backup, [first])
    output_of("study", "withdraw", study, first, "--yes")
    assert traces(tmp_path, [first, CODES[0], WORDS[0]]) == []


def test_nothing_but_an_id_or_a_code_withdraws_anybody(study: Path) -> None:
    first, second, _ = people(study)
    folder = ExperimentFolder(study)
    with ExperimentLog(folder.log) as log:
        conductor = Conductor(folder.read(), log, lambda: NOON, random.Random(1).randrange)
        conductor.exclude(second, "was asleep")
        # Somebody without a completion code.
        conductor.admit()
    before = contents(study)
    inside = (f"recordings/{first}", f"../recordings/{first}", f"{first}/", f"./{first}", f"{first}/.", str(study))
    for named in ("..", ".", "", " ", "\t", "/", "/etc", "recordings", "P-", "P-\0", "*", "log", *inside):
        done = invoke("study", "withdraw", study, named, "--yes")
        assert done.exit_code == 2, (named, done.output)
        assert "lists the ids" in done.output
        assert contents(study) == before, named


def contents(folder: Path) -> dict[Path, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file() and path.name not in {"log-shm", "log-wal"})
    return {path: path.read_bytes() for path in files}


def test_what_is_deleted_is_shown_and_confirmed_first(
    study: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    export, backup, (first, *_) = tmp_path / "export", tmp_path / "backup", people(study)
    output_of("study", "export", study, "--to", export)
    output_of("study", "backup", study, "--to", backup)
    before = contents(tmp_path)
    events = [entry.event for entry in read_log(study / "store" / "log") if not isinstance(entry, Tombstone)]
    files = len([path for path in (study / "recordings" / first).rglob("*") if path.is_file()])

    done = invoke("study", "withdraw", study, first)

    assert done.exit_code == 2
    assert "add --yes" in done.output
    said = " ".join(done.output.split())
    assert f"log: {sum(event.participant == first for event in events)} entries will be deleted" in said
    assert f"{study / 'recordings' / first}: {files} files, 0.1 MB, will be deleted" in said
    assert f"{export}: this export will be written again without {first}" in said
    assert f"{backup}: this backup will be updated" in said
    monkeypatch.setattr("typer.testing._NamedTextIOWrapper.isatty", lambda _: True, raising=False)
    refused = invoke("study", "withdraw", study, first, input="n\n")
    assert refused.exit_code == 1
    assert "Nothing was deleted." in refused.output
    assert contents(tmp_path) == before
    assert invoke("study", "withdraw", study, first, input="y\n").exit_code == 0
    assert traces(tmp_path, [first, CODES[0], WORDS[0]]) == []


COMMANDS = {
    "status": (),
    "check": (),
    "freeze": (),
    "export": ("--to", "OUT"),
    "backup": ("--to", "OUT"),
    "rehearse": ("--to", "OUT", "--no-games"),
    "watch": (),
    "preview": ("none",),
    "edit": (),
    "run": (),
    "power": ("--score", "none", "--factor", "none"),
    "withdraw": ("CODE",),
}


QUICK = {"status", "export", "withdraw"}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in COMMANDS]
)
def test_each_command_of_a_study_finishes_a_withdrawal_first(
    study: Path, tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("ui.windows.display.why_no_window", lambda: "no window")
    for module in ("ui.commands.study.run", "ui.commands.study.experiment", "ui.commands.study.edit"):
        monkeypatch.setattr(f"{module}.why_no_window", lambda: "There is no window.")
    first, *_ = people(study)
    folder = ExperimentFolder(study)
    plan = plan_withdrawal(folder, folder.read(), first)
    # A program was killed when it had written its intention and wiped the log.
    folder.pending_withdrawals.add(plan.withdrawal)
    with ExperimentLog(folder.log) as log:
        log.delete(sequences_of(log.read(), first), NOON)
    words = [{"OUT": tmp_path / "out", "CODE": plan.withdrawal.code}.get(word, word) for word in COMMANDS[name]]
    done = invoke("study", name, study, *words)
    assert f"The interrupted withdrawal of {first} is finished" in " ".join(done.output.split())
    assert traces(tmp_path, [first, CODES[0], WORDS[0]]) == []


def test_a_backup_is_refused_where_it_would_do_harm(study: Path, tmp_path: Path) -> None:
    assert "a backup inside the study's folder" in refusal_of("study", "backup", study, "--to", study / "backup")
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "one.jpg").write_bytes(b"x")
    assert "do not belong to a backup" in refusal_of("study", "backup", study, "--to", tmp_path / "photos")
    backup = tmp_path / "backup"
    output_of("study", "backup", study, "--to", backup)
    output_of("study", "withdraw", backup, people(study)[0], "--yes")
    assert "the study was run in this folder" in refusal_of("study", "backup", study, "--to", backup)
    new = tmp_path / "new"
    (recording,) = sorted((study / "recordings").rglob("*.bag"))[:1]
    recording.unlink()
    assert "is missing" in refusal_of("study", "backup", study, "--to", new)
