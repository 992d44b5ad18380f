"""Exports that pandas, R and Psych-DS read, and fingerprints that tell what has changed."""

import hashlib
import itertools
import json
import shutil
from pathlib import Path

import pytest

from tests.support.disks.damaged_files import SOME_BITS, cuts, flips
from tests.support.studies.experiment_files import write_experiment
from thbridge.experiment.allocation.places import NoPlace
from thbridge.experiment.conductor import Conductor
from thbridge.experiment.export import folder as export_folder
from thbridge.experiment.export.folder import export_experiment
from thbridge.experiment.export.manifest import MANIFEST, _may_hold, exports_with, last_event_of, missing_exports
from thbridge.experiment.folder import ExperimentFolder
from thbridge.experiment.freeze import deviations, freeze
from thbridge.experiment.store.event_log import ExperimentLog, read_log
from thbridge.experiment.store.events import Clocks, EventKind
from thbridge.files.errors import BadFile

VERSIONS = {"thbridge": "1.0", "python": "3.11"}


@pytest.fixture(scope="module")
def experiment(tmp_path_factory: pytest.TempPathFactory) -> ExperimentFolder:
    """A full experiment in which robots that argue are trusted more."""
    folder = ExperimentFolder(tmp_path_factory.mktemp("experiment"))
    write_experiment(folder.root)
    design = folder.read()
    folder.log.parent.mkdir()
    ticks = itertools.count(1)
    with ExperimentLog(folder.log) as log:
        lab = Conductor(
            design, log, lambda: Clocks("2026-01-02T12:00:00Z", next(ticks) * 10**9), lambda n: next(ticks) * 7 % n
        )
        while not isinstance(run := lab.admit(), NoPlace):
            person = run.participant
            while (step := lab.begin(person)) is not None:
                for item in lab.form(step).items if step.entry.form else ():
                    argued = step.condition == 1
                    answer = item.correct or (item.options[0] if item.options else item.least + argued)
                    if item.reverse:
                        answer = item.greatest - argued
                    lab.tell(EventKind.ITEM_SHOWN, person, step, {"item": item.id}, "program")
                    lab.tell(EventKind.ITEM_GIVEN, person, step, {"item": item.id, "answer": answer}, "participant")
                lab.end(person, step)
    return folder


@pytest.fixture(scope="module")
def export(experiment: ExperimentFolder, tmp_path_factory: pytest.TempPathFactory) -> Path:
    to = tmp_path_factory.mktemp("export") / "first"
    export_experiment(experiment, experiment.read(), read_log(experiment.log), to, VERSIONS, ())
    return to


def test_two_exports_of_a_log_are_the_same_to_the_byte(
    experiment: ExperimentFolder, export: Path, tmp_path: Path
) -> None:
    export_experiment(experiment, experiment.read(), read_log(experiment.log), tmp_path / "second", VERSIONS, ())
    first, second = (
        {path.relative_to(root): path.read_bytes() for path in root.rglob("*") if path.is_file()}
        for root in (export, tmp_path / "second")
    )
    assert first == second


def test_exports_that_hold_somebody_are_found_and_those_that_are_gone_told(
    experiment: ExperimentFolder, tmp_path: Path
) -> None:
    root = tmp_path / "study"
    shutil.copytree(experiment.root, root)
    study = ExperimentFolder(root)
    (root / "store" / "exports.json").unlink(missing_ok=True)
    design, entries = study.read(), read_log(study.log)
    inside, outside, moved = root / "exports" / "first", tmp_path / "second", tmp_path / "third"
    for to in (inside, outside, moved):
        export_experiment(study, design, entries, to, VERSIONS, None)
    person = next(iter(json.loads((inside / MANIFEST).read_text())["participants"]))
    assert person not in (root / "store" / "exports.json").read_text()
    moved.rename(tmp_path / "fourth")
    assert exports_with(study, person) == (inside, outside)
    assert missing_exports(study) == (moved,)
    assert exports_with(study, "P-NOBODY") == ()
    # One that was never finished may hold anybody.
    (outside / MANIFEST).unlink()
    assert exports_with(study, "P-NOBODY") == (outside,)
    root.rename(tmp_path / "renamed")
    assert exports_with(ExperimentFolder(tmp_path / "renamed"), person)[0] == tmp_path / "renamed" / "exports" / "first"


def test_an_export_whose_manifest_was_damaged_is_not_passed_over_for_who_withdraws(
    experiment: ExperimentFolder, tmp_path: Path
) -> None:
    study = ExperimentFolder(tmp_path / "study")
    shutil.copytree(experiment.root, study.root)
    export = study.root / "exports" / "first"
    export_experiment(study, study.read(), read_log(study.log), export, VERSIONS, None)
    whole = (export / MANIFEST).read_bytes()
    people = json.loads(whole)["participants"]
    for what, damaged in (*flips(whole, SOME_BITS), *cuts(whole)):
        (export / MANIFEST).write_bytes(damaged)
        for person in people:
            assert _may_hold(export, person), what
        assert last_event_of(export) in {None, json.loads(whole)["events"]}, what


def test_the_methods_text_has_people_orders_and_reliability(export: Path) -> None:
    text = (export / "methods.md").read_text()
    assert "Of 8 participants who began, 8 completed the study and were analyzed." in text
    assert text.count("| noise.preset=none | dialogue.condition=") == 2
    assert "| trust | trust | dialogue.condition=supervisor | 12 | 8 |" in text
    assert "thbridge 1.0" in text


def test_checksums_are_those_of_the_files(export: Path) -> None:
    lines = (export / "checksums.sha256").read_text().splitlines()
    for line in lines:
        digest, name = line.split("  ")
        assert hashlib.sha256((export / name).read_bytes()).hexdigest() == digest
    assert len(lines) == sum(path.is_file() for path in export.rglob("*")) - 1


def test_an_export_under_way_may_hold_somebody(
    experiment: ExperimentFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(experiment.root, tmp_path / "study")
    study, to = ExperimentFolder(tmp_path / "study"), tmp_path / "tables"
    found: list[tuple[Path, ...]] = []

    def look(*_: object) -> str:
        found.append(exports_with(study, "P-ANY"))
        assert [path.name for path in tmp_path.iterdir() if path != study.root] == ["tables"]
        return ""

    monkeypatch.setattr(export_folder, "methods_text", look)
    export_experiment(study, study.read(), read_log(study.log), to, VERSIONS, ())
    assert found == [(to,)]
    assert exports_with(study, "P-ANY") == ()


def test_an_export_goes_into_an_empty_folder_only(experiment: ExperimentFolder, export: Path) -> None:
    with pytest.raises(BadFile, match="this folder is not empty"):
        export_experiment(experiment, experiment.read(), read_log(experiment.log), export, VERSIONS, None)


def test_a_fingerprint_tells_what_has_changed_since(tmp_path: Path) -> None:
    folder = ExperimentFolder(tmp_path)
    write_experiment(tmp_path)
    assert deviations(folder, VERSIONS) is None
    freeze(folder, VERSIONS, "2026-01-02T12:00:00Z")
    folder.log.parent.mkdir()
    folder.log.write_bytes(b"data are no deviation")
    assert deviations(folder, VERSIONS) == ()
    (tmp_path / "welcome.md").write_text("Other words.\n")
    (tmp_path / "debrief.md").unlink()
    assert deviations(folder, {**VERSIONS, "thbridge": "1.1"}) == (
        "debrief.md was removed",
        "welcome.md was changed",
        "thbridge: now 1.1, when frozen 1.0",
    )
    with pytest.raises(BadFile, match="already frozen"):
        freeze(folder, VERSIONS, "2026-01-03T12:00:00Z")
    folder.freeze.write_text(folder.freeze.read_text().replace("1.0", "0.9"))
    with pytest.raises(BadFile, match="was changed"):
        deviations(folder, VERSIONS)
